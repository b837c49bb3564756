// A C interface to Jolt with what `src/engines/jolt.rs` asks for: compounds, meshes, ball joints and hinges,
// which the published C bindings lack.

#include <Jolt/Jolt.h>

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/JobSystemThreadPool.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/GroupFilter.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/ConvexHullShape.h>
#include <Jolt/Physics/Collision/Shape/MeshShape.h>
#include <Jolt/Physics/Collision/Shape/RotatedTranslatedShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/Collision/Shape/StaticCompoundShape.h>
#include <Jolt/Physics/Constraints/HingeConstraint.h>
#include <Jolt/Physics/Constraints/PointConstraint.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/RegisterTypes.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace {

using JPH::uint32;

// Static bodies, and moving ones.
constexpr JPH::ObjectLayer cStill = 0;
constexpr JPH::ObjectLayer cMoving = 1;

class Layers final : public JPH::BroadPhaseLayerInterface {
public:
	JPH::uint GetNumBroadPhaseLayers() const override { return 2; }
	JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer layer) const override {
		return JPH::BroadPhaseLayer(static_cast<JPH::BroadPhaseLayer::Type>(layer));
	}
#if defined(JPH_EXTERNAL_PROFILE) || defined(JPH_PROFILE_ENABLED)
	const char *GetBroadPhaseLayerName(JPH::BroadPhaseLayer) const override { return "layer"; }
#endif
};

class LayerAgainstTree final : public JPH::ObjectVsBroadPhaseLayerFilter {
public:
	bool ShouldCollide(JPH::ObjectLayer layer, JPH::BroadPhaseLayer tree) const override {
		return layer == cMoving || tree == JPH::BroadPhaseLayer(cMoving);
	}
};

class LayerAgainstLayer final : public JPH::ObjectLayerPairFilter {
public:
	bool ShouldCollide(JPH::ObjectLayer a, JPH::ObjectLayer b) const override {
		return a == cMoving || b == cMoving;
	}
};

// Bodies that share a joint don't collide. The group of a body is its number.
class Joined final : public JPH::GroupFilter {
public:
	bool CanCollide(const JPH::CollisionGroup &a, const JPH::CollisionGroup &b) const override {
		if (a.GetGroupID() >= mNeighbours.size())
			return true;
		const std::vector<uint32> &of = mNeighbours[a.GetGroupID()];
		return std::find(of.begin(), of.end(), b.GetGroupID()) == of.end();
	}
	void Join(uint32 a, uint32 b) {
		mNeighbours.resize(std::max<size_t>(mNeighbours.size(), std::max(a, b) + 1));
		mNeighbours[a].push_back(b);
		mNeighbours[b].push_back(a);
	}

private:
	// A handful for each body.
	std::vector<std::vector<uint32>> mNeighbours;
};

// From the stack while it lasts, then from the heap: a full stack ends the program.
class Scratch final : public JPH::TempAllocator {
public:
	explicit Scratch(JPH::uint size) : mStack(size), mFree(size) {}
	void *Allocate(JPH::uint size) override {
		const JPH::uint rounded = Rounded(size);
		if (rounded > mFree)
			return JPH::AlignedAllocate(std::max(size, 1u), 16);
		mFree -= rounded;
		return mStack.Allocate(size);
	}
	void Free(void *address, JPH::uint size) override {
		// Jolt gives back in reverse order, and null for nothing.
		if (address == nullptr)
			return;
		if (!Owns(address)) {
			JPH::AlignedFree(address);
			return;
		}
		mFree += Rounded(size);
		mStack.Free(address, size);
	}
	void Start() {
		mBase = static_cast<char *>(mStack.Allocate(16));
		mStack.Free(mBase, 16);
		mSize = mFree;
	}

private:
	static JPH::uint Rounded(JPH::uint size) { return (size + 15u) & ~15u; }
	bool Owns(void *address) const {
		const char *at = static_cast<char *>(address);
		return at >= mBase && at < mBase + mSize;
	}

	JPH::TempAllocatorImpl mStack;
	JPH::uint mFree;
	JPH::uint mSize = 0;
	char *mBase = nullptr;
};

struct World {
	// In the order in which they must outlive each other.
	Layers layers;
	LayerAgainstTree against_tree;
	LayerAgainstLayer against_layer;
	Scratch scratch{256u * 1024 * 1024};
	std::unique_ptr<JPH::JobSystem> jobs;
	JPH::PhysicsSystem system;
	JPH::Ref<Joined> joined = new Joined;
	std::vector<JPH::BodyID> bodies;
	std::vector<JPH::BodyID> dynamic;
	// Shapes that bodies share.
	std::map<uint64_t, JPH::ShapeSettings::ShapeResult> shared;
	int steps = 1;

	JPH::Body *Body(uint32 index) const {
		return system.GetBodyLockInterfaceNoLock().TryGetBody(bodies[index]);
	}
};

JPH::Vec3 Vec(const float *v) { return JPH::Vec3(v[0], v[1], v[2]); }

JPH::Quat Turn(const float *q) { return JPH::Quat(q[0], q[1], q[2], q[3]); }

} // namespace

extern "C" {

struct PeersWorldDef {
	float gravity[3];
	uint32 bodies;
	uint32 threads;
	uint32 steps;
};

// A part of a body; `points` and `indices` by kind.
struct PeersShape {
	// Its identity, if bodies share it; 0 if not.
	uint64_t key;
	// 0 sphere, 1 capsule, 2 box, 3 hull, 4 mesh.
	uint32 kind;
	float density;
	float position[3];
	float rotation[4];
	// Radius; half height and radius; half sides.
	float size[3];
	const float *points;
	uint32 point_count;
	const uint32 *indices;
	uint32 triangle_count;
};

struct PeersBody {
	// 0 static, 1 kinematic, 2 dynamic.
	uint32 kind;
	float friction;
	float restitution;
	float position[3];
	float rotation[4];
	float linear[3];
	float angular[3];
	float max_speed;
	float max_spin;
	bool continuous;
	bool sleeping;
};

struct PeersJoint {
	uint32 bodies[2];
	// Of both sides, in the axes of each body and from its origin.
	float points[2][3];
	float axes[2][3];
	float normals[2][3];
	bool hinge;
	bool limited;
	bool driven;
	float range[2];
	// Speed and torque.
	float motor[2];
};

struct PeersState {
	float position[3];
	float rotation[4];
	float linear[3];
	float angular[3];
};

World *peers_world_new(const PeersWorldDef *def) {
	static const bool is_registered = [] {
		JPH::RegisterDefaultAllocator();
		JPH::Factory::sInstance = new JPH::Factory;
		JPH::RegisterTypes();
		return true;
	}();
	(void)is_registered;
	World *world = new World;
	world->scratch.Start();
	// The thread that steps works too.
	if (def->threads > 1)
		world->jobs.reset(new JPH::JobSystemThreadPool(
			JPH::cMaxPhysicsJobs, JPH::cMaxPhysicsBarriers, static_cast<int>(def->threads) - 1));
	else
		world->jobs.reset(new JPH::JobSystemSingleThreaded(JPH::cMaxPhysicsJobs));
	world->steps = static_cast<int>(def->steps);
	// Its tables have a fixed size: contacts beyond it are lost, and the step says so.
	const uint32 bodies = std::max(def->bodies + 16u, 1024u);
	world->system.Init(bodies, 0, 24 * bodies, 16 * bodies, world->layers, world->against_tree,
		world->against_layer);
	world->system.SetGravity(Vec(def->gravity));
	return world;
}

void peers_world_delete(World *world) { delete world; }

} // extern "C"

namespace {

JPH::ShapeSettings::ShapeResult Create(const PeersShape &shape) {
	using namespace JPH;
	const auto solid = [&](ConvexShapeSettings *settings) {
		Ref<ConvexShapeSettings> owned = settings;
		if (shape.density > 0.0f)
			settings->SetDensity(shape.density);
		return settings->Create();
	};
	switch (shape.kind) {
	case 0:
		return solid(new SphereShapeSettings(shape.size[0]));
	case 1:
		return solid(new CapsuleShapeSettings(shape.size[0], shape.size[1]));
	case 2: {
		// A box is rounded by no more than it is thick.
		const Vec3 half = Vec(shape.size);
		return solid(new BoxShapeSettings(half, std::min(cDefaultConvexRadius, 0.5f * half.ReduceMin())));
	}
	case 3: {
		Array<Vec3> points;
		for (uint32 i = 0; i < shape.point_count; ++i)
			points.push_back(Vec(shape.points + 3 * i));
		return solid(new ConvexHullShapeSettings(points));
	}
	default: {
		VertexList vertices;
		vertices.reserve(shape.point_count);
		for (uint32 i = 0; i < shape.point_count; ++i) {
			const float *p = shape.points + 3 * i;
			vertices.push_back(Float3(p[0], p[1], p[2]));
		}
		IndexedTriangleList triangles;
		triangles.reserve(shape.triangle_count);
		for (uint32 i = 0; i < shape.triangle_count; ++i) {
			const uint32 *t = shape.indices + 3 * i;
			triangles.push_back(IndexedTriangle(t[0], t[1], t[2]));
		}
		Ref<MeshShapeSettings> settings = new MeshShapeSettings(std::move(vertices), std::move(triangles));
		return settings->Create();
	}
	}
}

bool IsMoved(const PeersShape &shape) {
	return Vec(shape.position) != JPH::Vec3::sZero() || Turn(shape.rotation) != JPH::Quat::sIdentity();
}

// One shape, a shape that is moved, or a compound; null if Jolt refuses one.
JPH::RefConst<JPH::Shape> Whole(World *world, const PeersShape *shapes, uint32 count) {
	using namespace JPH;
	StaticCompoundShapeSettings *compound = new StaticCompoundShapeSettings;
	Ref<StaticCompoundShapeSettings> owned = compound;
	for (uint32 i = 0; i < count; ++i) {
		const uint64_t key = shapes[i].key;
		const bool is_known = key != 0 && world->shared.count(key) != 0;
		ShapeSettings::ShapeResult part = is_known ? world->shared[key] : Create(shapes[i]);
		if (part.HasError())
			return nullptr;
		if (key != 0)
			world->shared[key] = part;
		if (count == 1 && !IsMoved(shapes[i]))
			return part.Get().GetPtr();
		if (count == 1)
			return new RotatedTranslatedShape(
				Vec(shapes[i].position), Turn(shapes[i].rotation), part.Get().GetPtr());
		compound->AddShape(Vec(shapes[i].position), Turn(shapes[i].rotation), part.Get().GetPtr());
	}
	ShapeSettings::ShapeResult whole = compound->Create();
	return whole.HasError() ? nullptr : whole.Get().GetPtr();
}

} // namespace

extern "C" {

bool peers_add_body(World *world, const PeersBody *def, const PeersShape *shapes, uint32 count) {
	using namespace JPH;
	const RefConst<Shape> shape = Whole(world, shapes, count);
	if (shape == nullptr)
		return false;
	const EMotionType kinds[] = {EMotionType::Static, EMotionType::Kinematic, EMotionType::Dynamic};
	BodyCreationSettings settings(shape, RVec3(Vec(def->position)), Turn(def->rotation), kinds[def->kind],
		def->kind == 0 ? cStill : cMoving);
	settings.mLinearVelocity = Vec(def->linear);
	settings.mAngularVelocity = Vec(def->angular);
	settings.mFriction = def->friction;
	settings.mRestitution = def->restitution;
	settings.mLinearDamping = 0.0f;
	settings.mAngularDamping = 0.0f;
	settings.mMaxLinearVelocity = def->max_speed;
	settings.mMaxAngularVelocity = def->max_spin;
	settings.mAllowSleeping = def->sleeping;
	settings.mMotionQuality = def->continuous ? EMotionQuality::LinearCast : EMotionQuality::Discrete;
	Body *body = world->system.GetBodyInterfaceNoLock().CreateBody(settings);
	if (body == nullptr)
		return false;
	world->bodies.push_back(body->GetID());
	if (def->kind == 2)
		world->dynamic.push_back(body->GetID());
	return true;
}

void peers_add_joint(World *world, const PeersJoint *joint) {
	using namespace JPH;
	Body *bodies[2];
	for (int side = 0; side < 2; ++side) {
		bodies[side] = world->Body(joint->bodies[side]);
		bodies[side]->SetCollisionGroup(CollisionGroup(world->joined, joint->bodies[side], 0));
	}
	world->joined->Join(joint->bodies[0], joint->bodies[1]);
	const auto point = [&](int side) {
		return RVec3(Vec(joint->points[side]) - bodies[side]->GetShape()->GetCenterOfMass());
	};
	if (!joint->hinge) {
		PointConstraintSettings settings;
		settings.mSpace = EConstraintSpace::LocalToBodyCOM;
		settings.mPoint1 = point(0);
		settings.mPoint2 = point(1);
		world->system.AddConstraint(settings.Create(*bodies[0], *bodies[1]));
		return;
	}
	HingeConstraintSettings settings;
	settings.mSpace = EConstraintSpace::LocalToBodyCOM;
	settings.mPoint1 = point(0);
	settings.mPoint2 = point(1);
	settings.mHingeAxis1 = Vec(joint->axes[0]);
	settings.mHingeAxis2 = Vec(joint->axes[1]);
	settings.mNormalAxis1 = Vec(joint->normals[0]);
	settings.mNormalAxis2 = Vec(joint->normals[1]);
	if (joint->limited) {
		settings.mLimitsMin = joint->range[0];
		settings.mLimitsMax = joint->range[1];
	}
	settings.mMotorSettings.SetTorqueLimit(joint->motor[1]);
	HingeConstraint *hinge = static_cast<HingeConstraint *>(settings.Create(*bodies[0], *bodies[1]));
	if (joint->driven) {
		hinge->SetMotorState(EMotorState::Velocity);
		hinge->SetTargetAngularVelocity(joint->motor[0]);
	}
	world->system.AddConstraint(hinge);
}

// Puts all bodies into the world, once there are all.
void peers_start(World *world) {
	using namespace JPH;
	std::vector<BodyID> ids = world->bodies;
	BodyInterface &bodies = world->system.GetBodyInterfaceNoLock();
	const int count = static_cast<int>(ids.size());
	const BodyInterface::AddState state = bodies.AddBodiesPrepare(ids.data(), count);
	bodies.AddBodiesFinalize(ids.data(), count, state, EActivation::Activate);
	world->system.OptimizeBroadPhase();
}

// Errors that Jolt reports, by bits; 0 for none.
uint32 peers_step(World *world, float dt) {
	return static_cast<uint32>(
		world->system.Update(dt, world->steps, &world->scratch, world->jobs.get()));
}

// Sets the velocities of a kinematic body.
void peers_drive(World *world, uint32 index, const float *linear, const float *angular) {
	world->system.GetBodyInterfaceNoLock().SetLinearAndAngularVelocity(
		world->bodies[index], Vec(linear), Vec(angular));
}

void peers_state(const World *world, uint32 index, PeersState *state) {
	using namespace JPH;
	const Body *body = world->Body(index);
	Vec3(body->GetPosition()).StoreFloat3(reinterpret_cast<Float3 *>(state->position));
	body->GetRotation().GetXYZW().StoreFloat4(reinterpret_cast<Float4 *>(state->rotation));
	const bool moves = !body->IsStatic();
	(moves ? body->GetLinearVelocity() : Vec3::sZero())
		.StoreFloat3(reinterpret_cast<Float3 *>(state->linear));
	(moves ? body->GetAngularVelocity() : Vec3::sZero())
		.StoreFloat3(reinterpret_cast<Float3 *>(state->angular));
}

uint32 peers_asleep(const World *world) {
	uint32 count = 0;
	for (const JPH::BodyID &id : world->dynamic)
		count += !world->system.GetBodyInterfaceNoLock().IsActive(id);
	return count;
}

} // extern "C"
