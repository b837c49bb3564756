// A ball falls onto a floor and comes to rest at its radius; a snapshot takes the world back to the same bits.
// Ends with 0 if all of that holds.

#include "backstop.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define CHECK(condition)                                                          \
    do {                                                                          \
        if (!(condition)) {                                                       \
            fprintf(stderr, "line %d: %s: %s\n", __LINE__, #condition, bs_last_error()); \
            exit(1);                                                              \
        }                                                                         \
    } while (0)

#define OK(call) CHECK((call) == BS_OK)

static BsBody add(BsWorld *world, BsBodyKind kind, BsGeometry geometry, BsDVec3 position) {
    BsShapeDesc shape = bs_shape_desc_default(geometry);
    shape.events = 1;
    BsBodyDesc desc = bs_body_desc_default();
    desc.kind = kind;
    desc.position = position;
    desc.shapes = &shape;
    desc.shape_count = 1;
    BsBody body;
    OK(bs_world_add_body(world, &desc, &body));
    return body;
}

static uint64_t run(BsWorld *world, int steps) {
    uint64_t hash;
    for (int i = 0; i < steps; i++) {
        OK(bs_world_step(world, 1.0f / 60.0f));
    }
    OK(bs_world_state_hash(world, &hash));
    return hash;
}

int main(void) {
    CHECK(bs_abi_version() >= BS_ABI_VERSION);

    BsSettings settings = bs_settings_default();
    BsWorld *world;
    OK(bs_world_create(&settings, &world));
    BsBody floor = add(world, BS_BODY_STATIC, bs_box(5.0f, 0.5f, 5.0f), (BsDVec3){0.0, -0.5, 0.0});
    BsBody ball = add(world, BS_BODY_DYNAMIC, bs_sphere(0.25f), (BsDVec3){0.0, 2.0, 0.0});

    // It touches the floor after sqrt(2 * 1.75 m / 9.81 m/s^2) = 0.6 s.
    int landed = 0;
    for (int i = 0; i < 60; i++) {
        const BsContactEvent *events;
        size_t count;
        OK(bs_world_step(world, 1.0f / 60.0f));
        OK(bs_world_contact_begins(world, &events, &count));
        if (count > 0 && landed == 0) {
            CHECK(count == 1);
            CHECK(events[0].bodies[0].slot == floor.slot && events[0].bodies[1].slot == ball.slot);
            landed = i;
        }
    }
    CHECK(landed >= 34 && landed <= 37);

    BsSnapshot *snapshot;
    OK(bs_snapshot_create(&snapshot));
    OK(bs_world_snapshot(world, snapshot));
    uint64_t first = run(world, 60);
    OK(bs_world_restore(world, snapshot));
    CHECK(run(world, 60) == first);

    BsPose pose;
    OK(bs_body_pose(world, ball, &pose));
    CHECK(fabs(pose.position.y - 0.25) < 1e-3);

    // From above: the top of the ball.
    BsRay ray = {{0.0, 5.0, 0.0}, {0.0f, -10.0f, 0.0f}, 0};
    BsHit hit;
    OK(bs_world_cast_ray(world, ray, NULL, &hit));
    CHECK(hit.hit && hit.body.slot == ball.slot && fabs(hit.point.y - 0.5) < 1e-3);

    // A removed body is an error, and says so.
    OK(bs_world_remove_body(world, ball));
    CHECK(bs_body_pose(world, ball, &pose) == BS_ERROR_STALE_BODY);
    printf("at rest at %.4f m, hash %016llx\n", pose.position.y, (unsigned long long)first);
    printf("then: %s\n", bs_last_error());

    bs_snapshot_destroy(snapshot);
    bs_world_destroy(world);
    return 0;
}
