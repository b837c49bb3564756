// A chain of planks between two posts bears a crate; RAII keeps the objects, exceptions carry refusals.
// Ends with 0 if all of that holds.

#include "backstop.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

void check(BsStatus status) {
    if (status != BS_OK) {
        throw std::runtime_error(std::string(bs_error_text(status)) + ": " + bs_last_error());
    }
}

void expect(bool condition, const char *what) {
    if (!condition) {
        throw std::logic_error(what);
    }
}

struct Destroy {
    void operator()(BsWorld *world) const { bs_world_destroy(world); }
    void operator()(BsSnapshot *snapshot) const { bs_snapshot_destroy(snapshot); }
    void operator()(const BsHull *hull) const { bs_hull_release(hull); }
};

// Owns a world; the calls that this program needs, as methods.
class World {
public:
    World() {
        BsWorld *world = nullptr;
        check(bs_world_create(nullptr, &world));
        world_.reset(world);
    }

    BsBody add(BsBodyKind kind, const BsGeometry &geometry, BsDVec3 position) {
        BsShapeDesc shape = bs_shape_desc_default(geometry);
        BsBodyDesc desc = bs_body_desc_default();
        desc.kind = kind;
        desc.position = position;
        desc.shapes = &shape;
        desc.shape_count = 1;
        BsBody body;
        check(bs_world_add_body(get(), &desc, &body));
        return body;
    }

    // A hinge about z at a point of the world.
    BsJoint hinge(BsBody a, BsBody b, BsDVec3 point) {
        const float half = std::sqrt(0.5f);
        BsJointDesc desc = bs_joint_desc_default(BS_JOINT_HINGE, a, b);
        // The frames' x is the axis: a quarter turn about y takes it to -z.
        check(bs_joint_frames_at(get(), a, b, point, BsQuat{0.0f, half, 0.0f, half}, desc.frames));
        BsJoint joint;
        check(bs_world_add_joint(get(), &desc, &joint));
        return joint;
    }

    void step(int count) {
        for (int i = 0; i < count; i++) {
            check(bs_world_step(get(), 1.0f / 60.0f));
        }
    }

    std::uint64_t hash() const {
        std::uint64_t hash = 0;
        check(bs_world_state_hash(get(), &hash));
        return hash;
    }

    BsWorld *get() const { return world_.get(); }

private:
    std::unique_ptr<BsWorld, Destroy> world_;
};

void run() {
    World world;
    const int planks = 8;
    BsBody last = world.add(BS_BODY_STATIC, bs_box(0.1f, 0.1f, 0.5f), {-0.5, 0.0, 0.0});
    const BsBody far = world.add(BS_BODY_STATIC, bs_box(0.1f, 0.1f, 0.5f), {planks - 0.5, 0.0, 0.0});
    std::vector<BsBody> bridge;
    for (int i = 0; i < planks; i++) {
        const BsBody plank = world.add(BS_BODY_DYNAMIC, bs_box(0.45f, 0.05f, 0.5f), {double(i), 0.0, 0.0});
        world.hinge(last, plank, {i - 0.5, 0.0, 0.0});
        bridge.push_back(last = plank);
    }
    const BsJoint end = world.hinge(last, far, {planks - 0.5, 0.0, 0.0});

    // A crate out of a hull that only its shape keeps.
    std::vector<BsVec3> corners;
    for (int i = 0; i < 8; i++) {
        corners.push_back({i & 1 ? 0.3f : -0.3f, i & 2 ? 0.3f : -0.3f, i & 4 ? 0.3f : -0.3f});
    }
    BsBody crate;
    {
        const BsHull *hull = nullptr;
        check(bs_hull_create(corners.data(), corners.size(), &hull));
        const std::unique_ptr<const BsHull, Destroy> keep(hull);
        crate = world.add(BS_BODY_DYNAMIC, bs_hull(hull), {planks / 2 - 0.5, 1.0, 0.0});
    }

    world.step(60);
    BsSnapshot *made = nullptr;
    check(bs_snapshot_create(&made));
    const std::unique_ptr<BsSnapshot, Destroy> snapshot(made);
    check(bs_world_snapshot(world.get(), made));
    world.step(300);
    const std::uint64_t first = world.hash();
    check(bs_world_restore(world.get(), made));
    world.step(300);
    expect(world.hash() == first, "a restored world goes on to the same bits");

    // Where everything is, in one call.
    struct Place {
        float position[3];
        float rotation[4];
    };
    bridge.push_back(crate);
    std::vector<Place> places(bridge.size());
    BsColumns columns = bs_columns_default();
    columns.position_type = BS_POSITIONS_F32;
    columns.positions = places[0].position;
    columns.rotations = places[0].rotation;
    columns.position_stride = columns.rotation_stride = sizeof(Place);
    check(bs_world_read_bodies(world.get(), bridge.data(), bridge.size(), &columns));
    for (int i = 0; i < planks; i++) {
        expect(places[i].position[1] < 0.0f, "each plank hangs below the posts");
        expect(std::fabs(places[i].position[0] - i) < 0.3f, "no plank leaves its place");
    }
    expect(places.back().position[1] > places[planks / 2].position[1], "the crate lies on the bridge");

    // The bridge carries half of the weight at each end, and the planks outnumber the crate.
    BsVec3 force;
    float plank_mass = 0.0f, crate_mass = 0.0f;
    check(bs_joint_force(world.get(), end, &force, nullptr));
    check(bs_body_mass(world.get(), bridge[0], &plank_mass));
    check(bs_body_mass(world.get(), crate, &crate_mass));
    const float half = 0.5f * 9.81f * (planks * plank_mass + crate_mass);
    expect(std::fabs(std::fabs(force.y) - half) < 0.05f * half, "an end bears half of the weight");

    BsStepReport report = {sizeof report};
    check(bs_world_report(world.get(), &report));
    std::printf("%d planks bear %.0f kg, an end %.0f N\n", planks, crate_mass, force.y);
    expect(report.manifolds > 0, "the crate touches the bridge");

    try {
        world.add(BS_BODY_DYNAMIC, bs_sphere(-1.0f), {0.0, 0.0, 0.0});
        expect(false, "a ball without size is refused");
    } catch (const std::runtime_error &refused) {
        std::printf("refused: %s\n", refused.what());
    }
}

} // namespace

int main() {
    try {
        run();
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
