// backstop: rigid-body physics for game runtimes, in C. Made by cbindgen from bindings/c/src: don't edit.
//
// SI units, y up, right-handed. Positions in the world are double, all else is float.
//
// Every function that can fail returns a BsStatus and writes its result through a pointer. A refused call has
// changed nothing; bs_last_error() has its reason in words. Structs with a `size` are made by their
// bs_..._default() function, or, if they are results, by `BsStepReport report = { sizeof report };`.
// A call with a buffer writes the number of elements that there are to `count`, and the elements only if all
// fit: with a capacity of zero it counts (and returns BS_ERROR_BUFFER unless there are none).
//
// What the library can't check is the caller's promise: pointers are null or to what the function says, objects
// are destroyed once and not used after.


#ifndef BACKSTOP_H
#define BACKSTOP_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && !defined(BS_STATIC)
#define BS_API __declspec(dllimport)
#else
#define BS_API
#endif


// Version of the interface: it grows with each release that changes it.
#define BS_ABI_VERSION 2

// No triangle: the shape is no mesh and no height field.
#define BS_NO_TRIANGLE UINT32_MAX

// No parent: a root.
#define BS_NO_BONE UINT32_MAX

// No limit of bytes.
#define BS_NO_LIMIT UINT64_MAX

// Places for categories in budgets and reports; more than there are, so that new ones find theirs.
#define BS_CATEGORIES 16

// A capsule, or another convex shape, that walks, climbs steps, slides along walls and is carried by what it
// stands on. Calls that take it as `const` may come from any number of threads at once.
typedef struct BsCharacter BsCharacter;

// A grid of heights. It has a count of references, as a `BsHull` has.
typedef struct BsHeightField BsHeightField;

// A convex hull. It has a count of references: `bs_hull_create` gives the first, and it is gone when all are
// released and no shape uses it. All calls on it may come from any thread at any time.
typedef struct BsHull BsHull;

// A mesh of triangles. It has a count of references, as a `BsHull` has.
typedef struct BsMesh BsMesh;

// What a ragdoll is made of: its bodies and joints, and which bones they are. It never changes, and may be
// used by any number of threads. The bodies and joints are the world's; they stay when this is destroyed.
typedef struct BsRagdoll BsRagdoll;

// A recording that is played again, step after step, in a world of its own.
typedef struct BsReplay BsReplay;

// The state of a world. It may be used by several threads as long as none of them writes it.
typedef struct BsSnapshot BsSnapshot;

// Bodies that move, collide and come to rest. Calls that take it as `const` may come from any number of
// threads at once. One that changes it waits up to a second for those under way, and is refused with
// `BS_ERROR_BUSY` beside another that changes it, and within a callback. Calls that begin beside a change,
// or while one waits, are refused with `BS_ERROR_BUSY`: try again.
typedef struct BsWorld BsWorld;

// Result of a call: `BS_OK`, or why it was refused. A refused call has changed nothing, unless it says so.
// Numbers never change their meaning; new ones may come.
typedef int32_t BsStatus;

// A vector, in single precision.
typedef struct BsVec3 {
    // To the right.
    float x;
    // Up.
    float y;
    // Towards the viewer.
    float z;
} BsVec3;

// How two coefficients become one, one of `BS_COMBINE_...`; of two shapes the later in this list decides.
typedef uint32_t BsCombine;

// Friction and restitution.
typedef struct BsMaterial {
    // Coulomb coefficient while the surfaces stick. Must be at least zero. Default 0.6.
    float static_friction;
    // Coulomb coefficient while they slide. Must be at least zero. Default 0.6.
    float dynamic_friction;
    // Share of the approach speed that comes back. Must be in 0..=1. Default 0.
    float restitution;
    // How two coefficients of friction become one. Default `BS_COMBINE_AVERAGE`.
    BsCombine friction_combine;
    // How two coefficients of restitution become one. Default `BS_COMBINE_AVERAGE`.
    BsCombine restitution_combine;
    // Zero.
    uint32_t reserved;
} BsMaterial;

// What few materials have: friction against rolling and spinning, a belt, and a spring. All zeros is
// none of them.
typedef struct BsSurface {
    // Lever arm of the load against rolling [m]: the torque against rotation about axes in the surface is
    // at most this times the normal force (the coefficient of rolling resistance as a length). A solid ball
    // of radius r on a level floor slows down by (5/7) g b / r, and stays on slopes below atan(b / r). Must
    // be in 0..=1e6 m. Default 0.
    float rolling_friction;
    // Lever arm of the load against spinning [m]: the torque against rotation about the normal is at most
    // this times the normal force, beside the torque of sliding friction about the middle of a contact of
    // several points. Must be in 0..=1e6 m. Default 0.
    float spinning_friction;
    // Velocity at which the surface moves past the shape, in the shape's frame [m/s]: a belt. Friction
    // pulls touching bodies along. Must be within 1e6 along each axis. Default zero.
    struct BsVec3 surface_velocity;
    // Frequency of the spring with which the surface yields [Hz]; 0 for a rigid one, for which
    // `BsSettings::contact_hertz` counts. Must be in 0..=1e6 Hz. Default 0.
    float contact_hertz;
    // Damping ratio of that spring, 0..=100. Without a spring zero stands for the engine's default, 1.
    float contact_damping;
    // Zero.
    uint32_t reserved;
} BsSurface;

// Yes or no: zero is no, all else is yes. No C `bool`, whose other bytes would be undefined behaviour.
typedef uint8_t BsBool;

// What moves a body, one of `BS_BODY_...`.
typedef uint32_t BsBodyKind;

// A position in the world [m].
typedef struct BsDVec3 {
    // To the right.
    double x;
    // Up.
    double y;
    // Towards the viewer.
    double z;
} BsDVec3;

// A rotation, as a unit quaternion: (0, 0, 0, 1) is none.
typedef struct BsQuat {
    // Imaginary.
    float x;
    // Imaginary.
    float y;
    // Imaginary.
    float z;
    // Real.
    float w;
} BsQuat;

// What a geometry is, one of `BS_GEOMETRY_...`.
typedef uint32_t BsGeometryKind;

// The form of a shape in its own frame. What its kind does not speak of is not looked at. `bs_sphere` and
// others make one.
typedef struct BsGeometry {
    // What it is.
    BsGeometryKind kind;
    // [m], of a capsule or cylinder.
    float half_height;
    // [m], of a sphere, or the lower one of a capsule or cylinder.
    float radius;
    // [m], the upper one of a capsule or cylinder.
    float radius_top;
    // [m], of a box.
    struct BsVec3 half_extents;
    // Zero.
    uint32_t reserved;
    // The hull of such a shape, which keeps a reference of its own.
    const struct BsHull *hull;
    // The mesh of such a shape.
    const struct BsMesh *mesh;
    // The field of such a shape.
    const struct BsHeightField *height_field;
} BsGeometry;

// Which shapes collide. Two of the same group that is not zero do if it is positive, and don't if it is
// negative; all others if each has a category that the other's mask has.
typedef struct BsFilter {
    // Bits that this shape is. Default: bit 0.
    uint64_t category;
    // Bits that this shape collides with. Default: all.
    uint64_t mask;
    // Default 0.
    int32_t group;
    // Zero.
    uint32_t reserved;
} BsFilter;

// A shape to be put on a body.
typedef struct BsShapeDesc {
    // Size of this struct; `bs_shape_desc_default` fills it in.
    uint32_t size;
    // It pushes nothing, and notices what comes into it. Convex or a plane. Default no.
    BsBool sensor;
    // Its contacts are reported as events. Default no.
    BsBool events;
    // As a sensor it also notices static shapes, and surfaces of meshes and height fields. Default no.
    BsBool senses_static;
    // Zero.
    uint8_t reserved[1];
    // Its form. Default a ball without radius, which is refused.
    struct BsGeometry geometry;
    // Where its frame is in the body's [m].
    struct BsVec3 position;
    // How its frame is turned in the body's.
    struct BsQuat rotation;
    // Density [kg/m³], 0..=1e15; zero adds no mass. Default 1000.
    float density;
    // Friction and restitution.
    struct BsMaterial material;
    // Which shapes it collides with.
    struct BsFilter filter;
    // Free for the caller.
    uint64_t user_data;
    // Friction against rolling and spinning, a belt, a spring. Default none.
    struct BsSurface surface;
} BsShapeDesc;

// Mass, centre and inertia of a solid.
typedef struct BsMassProperties {
    // [kg]
    float mass;
    // In the frame of the shape or body [m].
    struct BsVec3 centre_of_mass;
    // About the centre, in the axes of the shape or body [kg m²]: a symmetric matrix.
    float inertia[9];
} BsMassProperties;

// How a body is kept from passing through others, one of `BS_CONTINUOUS_...`.
typedef uint32_t BsContinuousMode;

// A group of rows of the solver, one of `BS_ROWS_...`.
typedef uint32_t BsRowGroup;

// Axes of the world that a body can't move along or turn about, as bits: x is 1, y is 2, z is 4.
typedef uint8_t BsAxes;

// A body to be added.
typedef struct BsBodyDesc {
    // Size of this struct; `bs_body_desc_default` fills it in.
    uint32_t size;
    // What moves it. Default dynamic.
    BsBodyKind kind;
    // Where its origin is [m].
    struct BsDVec3 position;
    // How its axes are turned.
    struct BsQuat rotation;
    // Velocity of its centre of mass [m/s].
    struct BsVec3 linear_velocity;
    // About the world's axes [rad/s].
    struct BsVec3 angular_velocity;
    // Its shapes; several make a compound. Each has the size that the first says.
    const struct BsShapeDesc *shapes;
    // Number of shapes.
    size_t shape_count;
    // Mass, centre and inertia; null: from the shapes and their densities.
    const struct BsMassProperties *mass;
    // Factor on gravity. Default 1.
    float gravity_scale;
    // How it is kept from passing through others. Default `BS_CONTINUOUS_SEGMENT`.
    BsContinuousMode continuous;
    // Its rows are solved right after those of this group, if that is later. Default `BS_ROWS_NONE`.
    BsRowGroup solved_after;
    // World axes along which it can't move, as bits of `BS_AXIS_BIT_...`.
    BsAxes lock_translation;
    // World axes about which it can't turn.
    BsAxes lock_rotation;
    // Whether it may fall asleep. Default yes.
    BsBool can_sleep;
    // Zero.
    uint8_t reserved;
    // Free for the caller.
    uint64_t user_data;
    // Linear velocity decays as exp(-c t), at least zero [1/s]. Default 0.
    float linear_damping;
    // The same of angular velocity [1/s]. Default 0.
    float angular_damping;
    // No step leaves it faster, above zero [m/s]; infinity for no cap. Default infinity.
    float max_linear_speed;
    // The same of angular speed [rad/s]. Default infinity.
    float max_angular_speed;
} BsBodyDesc;

// A body of a world. Stale once the body is removed: a stale handle is an error, never another body. All
// zeros is no body. Of which world it is nobody knows.
typedef struct BsBody {
    // Place in the world.
    uint32_t slot;
    // How often the place was taken.
    uint32_t generation;
} BsBody;

// Where a body is and how it is turned.
typedef struct BsPose {
    // Position of the origin [m].
    struct BsDVec3 position;
    // Rotation of the axes.
    struct BsQuat rotation;
} BsPose;

// What positions are written as, one of `BS_POSITIONS_...`.
typedef uint32_t BsPositionType;

// Where poses and velocities of many bodies go: four columns, each with the bytes from one body to the
// next. A column that is null is left out. Buffers need no alignment; a stride may not be shorter than
// what is written, and zero is exactly that.
typedef struct BsColumns {
    // Size of this struct; `bs_columns_default` fills it in.
    uint32_t size;
    // What positions are written as. Default `BS_POSITIONS_F64`.
    BsPositionType position_type;
    // Positions of origins: three numbers each.
    void *positions;
    // Rotations: four `float`s each, x, y, z, w.
    void *rotations;
    // Linear velocities: three `float`s each [m/s].
    void *linear_velocities;
    // Angular velocities: three `float`s each [rad/s].
    void *angular_velocities;
    // Bytes from one to the next.
    uint32_t position_stride;
    // Bytes from one to the next.
    uint32_t rotation_stride;
    // Bytes from one to the next.
    uint32_t linear_stride;
    // Bytes from one to the next.
    uint32_t angular_stride;
} BsColumns;

// A shape on a body. Stale once it or its body is removed. All zeros is no shape.
typedef struct BsShape {
    // Place in the world.
    uint32_t slot;
    // How often the place was taken.
    uint32_t generation;
} BsShape;

// A point of a contact.
typedef struct BsContactPoint {
    // Midway between the two surfaces, where the bodies are now, in the world [m].
    struct BsDVec3 position;
    // Distance of the surfaces along the normal, negative in overlap [m].
    float separation;
    // Normal impulse of the last substep, at least zero [N s].
    float impulse;
} BsContactPoint;

// A contact of two bodies: up to four points with one normal. Two shapes may have several, if one is a mesh
// or a height field.
typedef struct BsContact {
    // The shape of the body that was asked for, and the other one.
    struct BsShape shapes[2];
    // The body that was asked for, and the other one.
    struct BsBody bodies[2];
    // Unit, from the first shape to the second.
    struct BsVec3 normal;
    // Number of points, 1..=4.
    uint32_t point_count;
    // Its points; zeros beyond their number.
    struct BsContactPoint points[4];
} BsContact;

// A body that moved in the last step: where it is and how fast.
typedef struct BsBodyMove {
    // The body.
    struct BsBody body;
    // Its user data.
    uint64_t user_data;
    // Pose of its origin in the world [m].
    struct BsPose pose;
    // Position of its centre of mass in the world [m].
    struct BsDVec3 centre_of_mass;
    // Velocity of its centre of mass [m/s].
    struct BsVec3 linear_velocity;
    // Angular velocity about the world's axes [rad/s].
    struct BsVec3 angular_velocity;
    // Whether it fell asleep since the step began; it is not listed again until it wakes.
    BsBool fell_asleep;
    // Zero.
    uint8_t reserved[7];
} BsBodyMove;

// A joint between two bodies. Stale once it breaks, or it or one of its bodies is removed. All zeros is no
// joint.
typedef struct BsJoint {
    // Place in the world.
    uint32_t slot;
    // How often the place was taken.
    uint32_t generation;
} BsJoint;

// A box along the axes of the world.
typedef struct BsAabb {
    // Its low corner [m].
    struct BsDVec3 min;
    // Its high corner [m].
    struct BsDVec3 max;
} BsAabb;

// Settings of a character.
typedef struct BsCharacterSettings {
    // Size of this struct; `bs_character_settings_default` fills it in.
    uint32_t size;
    // Radius of the capsule, above zero [m]. Default 0.3.
    float radius;
    // Half the distance between the centres of its two balls [m]: 1.8 m tall by default. Must be in
    // 0..=1e6. Default 0.6.
    float half_height;
    // The distance that it keeps from everything, above zero [m]: room for rounding and for moving bodies.
    // It stands this high above the ground. Default 0.02.
    float skin;
    // The steepest ground to stand and walk on [rad], 0..=1.57. Default 50 degrees.
    float max_slope;
    // The highest step to climb [m]. The round bottom gets over edges lower than `(radius + skin) * (1 -
    // cos(max_slope))` all the same. Must be in 0..=1e6. Default 0.3.
    float step_height;
    // A walking character stays on ground that drops by up to this [m]. Must be in 0..=1e6. Default 0.3.
    float snap;
    // Obstacles that a walk may slide along; the rest of the path is dropped. Must be in 1..=64. Default 8.
    uint32_t iterations;
    // The upward direction, a unit vector. Default y.
    struct BsVec3 up;
    // Mass for pushes on dynamic bodies and for its weight on them [kg]. Must be at least zero. Default 80.
    float mass;
    // The greatest force of a push [N]. Must be at least zero. Default 500.
    float strength;
} BsCharacterSettings;

// The caller's own say whether a shape is seen: not zero if it is. It may read the world, and must not
// change it, nor throw or jump out of the call.
typedef BsBool (*BsQueryPredicate)(void *user, struct BsBody body, struct BsShape shape);

// Which shapes a query sees.
typedef struct BsQueryFilter {
    // Size of this struct; `bs_query_filter_default` fills it in.
    uint32_t size;
    // Whether shapes of static bodies are seen. Default yes.
    BsBool statics;
    // Whether shapes of kinematic bodies are seen. Default yes.
    BsBool kinematic;
    // Whether shapes of dynamic bodies are seen. Default yes.
    BsBool dynamic;
    // Whether sensors are seen. Default no.
    BsBool sensors;
    // Whether what a ray starts in, or a moving shape overlaps at the start and moves out of, is not
    // seen. Default no.
    BsBool skip_inside;
    // Whether only shapes are seen that would collide with one of `filter`. Default no.
    BsBool has_filter;
    // Zero.
    uint8_t reserved[6];
    // See `has_filter`.
    struct BsFilter filter;
    // A body whose shapes are not seen; all zeros for none.
    struct BsBody exclude_body;
    // A shape that is not seen; all zeros for none.
    struct BsShape exclude_shape;
    // The caller's own say, asked last, or null. It may be asked more than once about a shape.
    BsQueryPredicate predicate;
    // What the predicate is called with.
    void *user;
    // The only body whose shapes are seen; all zeros for any.
    struct BsBody only_body;
    // The only shape that is seen, whatever `only_body` says; all zeros for any.
    struct BsShape only_shape;
} BsQueryFilter;

// What a character stands on.
typedef struct BsGround {
    // Whose shape it is.
    struct BsBody body;
    // Which shape.
    struct BsShape shape;
    // Where, in the world [m].
    struct BsDVec3 point;
    // Unit, out of the ground.
    struct BsVec3 normal;
    // How fast the ground moves at that point [m/s].
    struct BsVec3 velocity;
} BsGround;

// What came of a walk.
typedef struct BsCharacterReport {
    // Size of this struct, set by the caller.
    uint32_t size;
    // How far steps were climbed [m].
    float stepped;
    // Where the middle of the capsule is [m].
    struct BsDVec3 position;
    // The whole displacement [m].
    struct BsVec3 moved;
    // The part of it by moving ground [m].
    struct BsVec3 carried;
    // The part of it out of bodies that had moved into the character [m].
    struct BsVec3 pushed_out;
    // The velocity after obstacles [m/s]: relative to the ground if there is one, else in the world.
    struct BsVec3 velocity;
    // By how much the ground turned about `up` meanwhile [rad].
    float turned;
    // Remaining overlap of the capsule [m]; above zero only if it is squeezed.
    float overlap;
    // The ground, if `on_ground`.
    struct BsGround ground;
    // Whether it stands on something.
    BsBool on_ground;
    // Zero.
    uint8_t reserved[7];
} BsCharacterReport;

// What a character ran into.
typedef struct BsCharacterHit {
    // Whose shape it is.
    struct BsBody body;
    // Which shape.
    struct BsShape shape;
    // Where, in the world [m].
    struct BsDVec3 point;
    // Unit, from the obstacle towards the character.
    struct BsVec3 normal;
    // Impulse of the push on a dynamic body, zero for others [N s].
    struct BsVec3 impulse;
} BsCharacterHit;

// A character that lives in a world. Stale once it is removed. All zeros is no character.
typedef struct BsWorldCharacter {
    // Place in the world.
    uint32_t slot;
    // How often the place was taken.
    uint32_t generation;
} BsWorldCharacter;

// What to draw.
typedef struct BsDrawOptions {
    // Size of this struct; `bs_draw_options_default` fills it in.
    uint32_t size;
    // Shapes, in the colour of their body's kind. Default yes.
    BsBool shapes;
    // The box around each shape. Default no.
    BsBool aabbs;
    // The box that the broad phase keeps of each shape. Default no.
    BsBool fat_aabbs;
    // Swept paths of the last step. Default no.
    BsBool motion;
    // Points of contact. Default yes.
    BsBool contacts;
    // Normals and gaps at points of contact. Default no.
    BsBool normals;
    // Impulses at points of contact. Default no.
    BsBool impulses;
    // Frames, limits and gaps of joints. Default yes.
    BsBool joints;
    // Dynamic bodies in the colour of their island. Default no.
    BsBool islands;
    // Centres of mass and principal axes. Default no.
    BsBool centres;
    // Contacts in the colour that the solver gave them. Default no.
    BsBool solver_colours;
    // Whether only what is in the box from `region_min` to `region_max` is drawn. Default no.
    BsBool has_region;
    // Low corner [m].
    struct BsDVec3 region_min;
    // High corner [m].
    struct BsDVec3 region_max;
    // Length of normals and of the axes of frames [m]. Default 0.2.
    float length;
    // Length of an impulse of 1 N s [m]. Default 0.01.
    float impulse_scale;
} BsDrawOptions;

// What is drawn, one of `BS_ELEMENT_...`.
typedef uint32_t BsElement;

// What is drawn, and in which colour (sRGB).
typedef struct BsInk {
    // What it is.
    BsElement element;
    // 0 to 255.
    uint8_t red;
    // 0 to 255.
    uint8_t green;
    // 0 to 255.
    uint8_t blue;
    // Zero.
    uint8_t reserved;
} BsInk;

// A line of a drawing.
typedef struct BsLine {
    // One end, in the world [m].
    struct BsDVec3 from;
    // The other end.
    struct BsDVec3 to;
    // What it is.
    struct BsInk ink;
} BsLine;

// A point of a drawing.
typedef struct BsPoint {
    // Where, in the world [m].
    struct BsDVec3 at;
    // What it is.
    struct BsInk ink;
} BsPoint;

// A shape of a drawing, for renderers with meshes of their own (`bs_geometry_triangles`).
typedef struct BsDrawnShape {
    // Which: the same from call to call.
    struct BsShape shape;
    // Its body.
    struct BsBody body;
    // Kind of its body.
    BsBodyKind kind;
    // Zero.
    uint32_t reserved;
    // Its form, in its own frame. Its pointer is valid until the call returns.
    struct BsGeometry geometry;
    // Where its frame is in the world.
    struct BsPose pose;
    // What it is.
    struct BsInk ink;
} BsDrawnShape;

// Functions of the caller that draw. They may read the world, and must not change it, nor throw or jump
// out of the call. Each may be null.
typedef struct BsDrawCalls {
    // Size of this struct; `bs_draw_calls_default` fills it in.
    uint32_t size;
    // Zero.
    uint32_t reserved;
    // What the functions are called with.
    void *user;
    // Draws a line.
    void (*line)(void *user, const struct BsLine *line);
    // Draws a point.
    void (*point)(void *user, const struct BsPoint *point);
    // Draws a shape; null: shapes come as lines.
    void (*shape)(void *user, const struct BsDrawnShape *shape);
} BsDrawCalls;

// Two shapes that began to touch, or hit each other.
typedef struct BsContactEvent {
    // The shapes, the one with the lower handle first.
    struct BsShape shapes[2];
    // Their bodies.
    struct BsBody bodies[2];
    // Midway between the surfaces, at the point with the greatest impulse, at the start of the step [m].
    struct BsDVec3 point;
    // Unit, from the first shape to the second.
    struct BsVec3 normal;
    // Approach speed there before anything was solved [m/s]; negative if they separate.
    float approach_speed;
    // Normal impulse of the whole step, over all points [N s].
    float impulse;
    // Zero.
    uint32_t reserved;
} BsContactEvent;

// Two shapes that no longer touch, or of which one was removed.
typedef struct BsContactEnd {
    // The shapes, the one with the lower handle first.
    struct BsShape shapes[2];
} BsContactEnd;

// A shape that entered or left a sensor.
typedef struct BsSensorEvent {
    // The sensor.
    struct BsShape sensor;
    // The shape that crossed its surface.
    struct BsShape visitor;
    // When, as a fraction of the step.
    float fraction;
} BsSensorEvent;

// What a joint locks before its own limits and motors, one of `BS_JOINT_...`.
typedef uint32_t BsJointKind;

// Where a joint sits on a body, in the body's own axes and from its origin.
typedef struct BsFrame {
    // [m]
    struct BsVec3 position;
    // The joint's x, y and z in the body's axes.
    struct BsQuat rotation;
} BsFrame;

// What a spring's numbers are, one of `BS_SPRING_...`.
typedef uint32_t BsSpringKind;

// A spring with a damper.
typedef struct BsSpring {
    // What its numbers are.
    BsSpringKind kind;
    // By its kind.
    float stiffness;
    // By its kind.
    float damping;
} BsSpring;

// Sliding or turning, one of `BS_MOTION_...`.
typedef uint32_t BsMotion;

// Which axes of a joint's first frame, one of `BS_AXIS_...`, `BS_AROUND_...` and `BS_AXES_ALL`.
typedef uint32_t BsJointAxes;

// Keeps a displacement within a range. A range of no width locks.
typedef struct BsLimitDesc {
    // Size of this struct; `bs_limit_desc` fills it in.
    uint32_t size;
    // Sliding or turning.
    BsMotion motion;
    // Along or about which axes.
    BsJointAxes axes;
    // Least allowed [m] or [rad]; minus infinity for none.
    float min;
    // Most allowed, not below `min`; infinity for none.
    float max;
    // What pushes back beyond the range. Default none: rigid.
    struct BsSpring spring;
} BsLimitDesc;

// Pulls a displacement to a target position, a target velocity, or both, with a bounded force.
typedef struct BsMotorDesc {
    // Size of this struct; `bs_motor_desc` and others fill it in.
    uint32_t size;
    // Sliding or turning.
    BsMotion motion;
    // `BS_AXIS_X`, `BS_AXIS_Y` or `BS_AXIS_Z`.
    BsJointAxes axis;
    // [m] or [rad]
    float position;
    // [m/s] or [rad/s]
    float velocity;
    // How hard it pulls.
    struct BsSpring spring;
    // The most force [N] or torque [N m]; infinity for no bound.
    float max_force;
} BsMotorDesc;

// A joint to be added. The relative motion is that of the second frame as seen from the first.
typedef struct BsJointDesc {
    // Size of this struct; `bs_joint_desc_default` fills it in.
    uint32_t size;
    // What it locks.
    BsJointKind kind;
    // The two bodies, at least one of them dynamic.
    struct BsBody bodies[2];
    // Where the joint sits on each; `bs_joint_frames_at` makes them from a point of the world.
    struct BsFrame frames[2];
    // Distance joints: the least distance [m].
    float range_min;
    // Distance joints: the greatest distance; wheels: the travel [m].
    float range_max;
    // Wheels alone.
    struct BsSpring spring;
    // The joint breaks above this force [N]. Default infinity.
    float break_force;
    // The joint breaks above this torque [N m]. Default infinity.
    float break_torque;
    // Its rows are solved right after those of this group, if that is later. Default `BS_ROWS_NONE`.
    BsRowGroup solved_after;
    // Whether the two bodies collide with each other. Default no.
    BsBool collide;
    // Zero.
    uint8_t reserved[7];
    // What is kept within a range, beside what the kind locks. Each has the size that the first says.
    const struct BsLimitDesc *limits;
    // Number of limits.
    size_t limit_count;
    // What is driven.
    const struct BsMotorDesc *motors;
    // Number of motors.
    size_t motor_count;
    // Free for the caller.
    uint64_t user_data;
    // Above this force [N] the joint is in `bs_world_strained_joints`. Default infinity.
    float force_threshold;
    // The same of its torque [N m]. Default infinity.
    float torque_threshold;
} BsJointDesc;

// A joint that bore more than one of its thresholds.
typedef struct BsStrainedJoint {
    // The joint.
    struct BsJoint joint;
    // Its force on the second body in the last substep, in world axes [N].
    struct BsVec3 force;
    // Its torque on the second body about the joint [N m].
    struct BsVec3 torque;
} BsStrainedJoint;

// A motion of a joint that is coupled to another one.
typedef struct BsCoupledMotion {
    // The joint. It need not restrict this motion.
    struct BsJoint joint;
    // Sliding or turning.
    BsMotion motion;
    // Along or about which axes. An angle is about one axis.
    BsJointAxes axes;
    // Factor on the displacement, of magnitude 1e-9 to 1e9.
    double factor;
} BsCoupledMotion;

// A coupling to be added: the sum of two motions, each times its factor, is kept at a value or within a
// range.
typedef struct BsCouplingDesc {
    // Size of this struct; the functions that make one fill it in.
    uint32_t size;
    // Whether the sum is kept within `min` and `max`, and not at what it is when the coupling is added.
    BsBool has_range;
    // Zero.
    uint8_t reserved[3];
    // The two motions.
    struct BsCoupledMotion motions[2];
    // Least sum; minus infinity for none.
    double min;
    // Greatest sum; infinity for none.
    double max;
    // The coupling breaks if it exerts more on either motion [N] or [N m]. Default infinity.
    float break_force[2];
    // Free for the caller.
    uint64_t user_data;
} BsCouplingDesc;

// A coupling of two motions of joints. Stale once it breaks, or it or one of its joints is removed. All
// zeros is no coupling.
typedef struct BsCoupling {
    // Place in the world.
    uint32_t slot;
    // How often the place was taken.
    uint32_t generation;
} BsCoupling;

// A ray.
typedef struct BsRay {
    // Where it starts, in the world [m].
    struct BsDVec3 from;
    // From its start to its end [m]: direction times length.
    struct BsVec3 path;
    // Zero.
    uint32_t reserved;
} BsRay;

// What a ray or a moving shape meets.
typedef struct BsHit {
    // Whose shape it is.
    struct BsBody body;
    // Which shape.
    struct BsShape shape;
    // Where, in the world [m].
    struct BsDVec3 point;
    // Unit, out of the shape; towards the moving one. Zero if a ray starts inside.
    struct BsVec3 normal;
    // Fraction of the path, 0..=1.
    float fraction;
    // How far a moving shape that overlaps it at the start has to go along the normal to get out [m].
    float depth;
    // Index of the triangle of a mesh or height field, or `BS_NO_TRIANGLE`.
    uint32_t triangle;
    // Whether there is a hit at all. If not, all else is zero.
    BsBool hit;
    // Whether a ray starts inside of it.
    BsBool inside;
    // Zero.
    uint8_t reserved[6];
} BsHit;

// The point of a shape that is nearest to a given one.
typedef struct BsClosestPoint {
    // Whose shape it is.
    struct BsBody body;
    // Which shape.
    struct BsShape shape;
    // The nearest point, in the world [m]; inside a solid shape the given one.
    struct BsDVec3 point;
    // Unit, from the nearest point towards the given one. Zero inside.
    struct BsVec3 normal;
    // How far it is away [m]; zero inside.
    float distance;
    // Index of the triangle of a mesh or height field, or `BS_NO_TRIANGLE`.
    uint32_t triangle;
    // Whether there is one at all. If not, all else is zero.
    BsBool found;
    // Whether the given point is inside of it.
    BsBool inside;
    // Zero.
    uint8_t reserved[2];
} BsClosestPoint;

// A convex shape that moves and turns.
typedef struct BsShapeCast {
    // Size of this struct; `bs_shape_cast_default` fills it in.
    uint32_t size;
    // Path of its pivot [m].
    struct BsVec3 path;
    // Where its origin is at the start, and how it is turned.
    struct BsPose pose;
    // By how much it turns on the way: a rotation vector in the world [rad]. Default zero.
    struct BsVec3 spin;
    // The point that follows the path, in the shape's frame [m]. Default its origin.
    struct BsVec3 pivot;
    // The shape.
    const struct BsGeometry *shape;
} BsShapeCast;

// A shape that a query's shape overlaps.
typedef struct BsOverlap {
    // Whose shape it is.
    struct BsBody body;
    // Which shape.
    struct BsShape shape;
} BsOverlap;

// How a bone moves on its parent, one of `BS_BONE_...`.
typedef uint32_t BsBoneKind;

// A bone: a capsule on its parent.
typedef struct BsBoneDesc {
    // Size of this struct; `bs_bone_desc_default` fills it in.
    uint32_t size;
    // A bone before this one, or `BS_NO_BONE`.
    uint32_t parent;
    // Where it hangs on its parent [m].
    struct BsVec3 joint_at;
    // One end of the capsule, cap included [m].
    struct BsVec3 from;
    // The other end.
    struct BsVec3 to;
    // [m]
    float radius;
    // How it moves on its parent.
    BsBoneKind joint;
    // Half the angle of the cone of a ball, 0..=pi [rad].
    float swing;
    // To either side, of a ball, 0..=pi [rad].
    float twist;
    // Hinges: the axis, in the skeleton's axes; its length does not matter.
    struct BsVec3 axis;
    // Hinges: the least angle, at most zero [rad].
    float min;
    // Hinges: the greatest angle, at least zero [rad].
    float max;
} BsBoneDesc;

// Bones with what they are made of.
typedef struct BsSkeletonDesc {
    // Size of this struct; `bs_skeleton_desc_default` fills it in.
    uint32_t size;
    // [kg/m³]. Default 1000.
    float density;
    // Parents before children. Each has the size that the first says.
    const struct BsBoneDesc *bones;
    // Number of bones.
    size_t bone_count;
    // Material of all bones.
    struct BsMaterial material;
    // Filter of all bones. Neighbours never collide.
    struct BsFilter filter;
    // Torque of friction in each joint [N m]. Default 0.
    float friction;
    // Zero.
    uint32_t reserved;
    // Friction against rolling and spinning of all bones, and a belt. Default none.
    struct BsSurface surface;
} BsSkeletonDesc;

// What memory is for, one of `BS_CATEGORY_...`: an index into `BsMemoryReport::of` and
// `BsSettings::budget_of`.
typedef uint32_t BsCategory;

// How continuous collision is done, one of `BS_METHOD_...`.
typedef uint32_t BsMethod;

// Shape of the friction cone, one of `BS_FRICTION_CONE` and `BS_FRICTION_BOX`.
typedef uint32_t BsFrictionCone;

// Where friction acts, one of `BS_FRICTION_PER_...`.
typedef uint32_t BsFrictionModel;

// Settings of a world: gravity, solver, continuous collision, sleep, events, memory.
typedef struct BsSettings {
    // Size of this struct; `bs_settings_default` fills it in.
    uint32_t size;
    // Gravity [m/s²]. Must be within 1e6 along each axis. Default (0, -9.81, 0).
    struct BsVec3 gravity;
    // Substeps of the solver in a step. With 1 substep and several iterations the solver is plain
    // sequential impulses; with several substeps and 1 iteration it is soft substepping (Macklin et al.,
    // *Small Steps in Physics Simulation*, 2019). Must be in 1..=64. Default 4.
    uint32_t substeps;
    // Gauss-Seidel iterations in each substep. Must be in 1..=256. Default 1.
    uint32_t iterations;
    // Threads that a step may use, at least 1: the caller's, and those of a pool that the process
    // shares, with a thread for each processor (or RAYON_NUM_THREADS). The result never depends on it.
    // Default 1.
    uint32_t threads;
    // The actual mode of bodies with the mode segment. Default `BS_CONTINUOUS_SEGMENT`.
    BsContinuousMode continuous;
    // Default `BS_METHOD_ONE_PASS`.
    BsMethod continuous_method;
    // Default `BS_FRICTION_CONE`.
    BsFrictionCone friction_cone;
    // Default `BS_FRICTION_PER_PATCH`.
    BsFrictionModel friction_model;
    // Length of a typical body [m]; scales the lengths below. Must be in 1e-6..=1e6 m. Default 1.
    float length_unit;
    // Approach speed below which a contact does not bounce [m/s]: by default more than gravity gives a
    // resting body within a step of 1/30 s. Must be in 0..=1e6. Default 0.3.
    float restitution_threshold;
    // Overlap that sliding, rolling and new contacts keep, and a tenth of the maximum gap at which the
    // springs of resting contacts act [length units]. Must be in 0..=1. Default 0.0005.
    float slop;
    // Contact stiffness where both materials are rigid (see `BsSurface::contact_hertz`) [Hz], limited to
    // the stable maximum: 0.15 of the rate of substeps with one iteration, growing with the root of the
    // number of iterations. Must be in 1e-6..=1e6. Default 120.
    float contact_hertz;
    // Contact damping ratio (by default that of Catto, Box2D v3). Must be in 1e-6..=1e6. Default 10.
    float contact_damping;
    // Maximum speed at which overlap is pushed apart [m/s per length unit]. Where many bodies overlap each
    // other, they add up to at most five times as much. Must be in 1e-6..=1e6. Default 3.
    float push_speed;
    // Whether the solver starts with the impulses of the previous step. Default yes.
    BsBool warm_starting;
    // Whether contacts of pairs that hardly moved are kept without a new narrow phase. Default yes.
    BsBool recycling;
    // Whether joints that form trees are solved exactly, as a block. Otherwise all joints are solved row by
    // row, which is cheaper and lets chains stretch under load; it exists for comparison
    // (`docs/joints.md`). Default yes.
    BsBool joint_trees;
    // Whether the paths of continuous bodies are checked after the solver, and cut where a centre would
    // still pass through something (`docs/decisions/guard.md`). Without it bodies are stopped by contacts
    // alone; this exists to measure how well. Default yes.
    BsBool guard;
    // Whether bodies at rest fall asleep, in islands of connected bodies; until something wakes them they
    // take no time. Default no.
    BsBool sleeping;
    // Zero.
    uint8_t reserved[7];
    // A body counts as at rest while neither its centre nor, by its rotation alone, any point of it is
    // faster [m/s per length unit]. Must be at least zero. Default 0.05.
    float sleep_speed;
    // How long all bodies of an island must be at rest before it falls asleep [s]. Must be at least zero.
    // Default 0.5.
    float sleep_time;
    // Contacts with at least this approach speed are reported as hits [m/s per length unit]. Must be at
    // least zero. Default 1.
    float hit_speed;
    // Maximum number of events of each kind in a step; those beyond are counted in
    // `BsStepReport::events_lost`. Default 4096.
    uint32_t event_capacity;
    // The order in which groups of rows are solved, each of the seven once: the last is obeyed best. The
    // eighth place is not used.
    BsRowGroup order[8];
    // Bytes that the world may reserve in all. Additions beyond it are refused with `BS_ERROR_BUDGET`,
    // and a step leaves out the contacts that don't fit. Default `BS_NO_LIMIT`.
    uint64_t budget;
    // The same for each category, by `BS_CATEGORY_...`. Default `BS_NO_LIMIT`.
    uint64_t budget_of[BS_CATEGORIES];
} BsSettings;

// How a replay is played, and what a recording may ask for at most.
typedef struct BsReplayOptions {
    // Size of this struct; `bs_replay_options_default` fills it in.
    uint32_t size;
    // Threads to step with, 0 for as many as were recorded: their number does not matter to the bits.
    // Default 0.
    uint32_t threads;
    // Substeps, 0 for as many as were recorded: others diverge. Default 0.
    uint32_t substeps;
    // Iterations, 0 for as many as were recorded: others diverge. Default 0.
    uint32_t iterations;
    // Bytes of one block. Default 1 GiB.
    uint64_t bytes;
    // Vertices. Default 10 million.
    uint64_t vertices;
    // Triangles, two for a cell of a height field. Default 10 million.
    uint64_t triangles;
    // Bodies at a time. Default 1 million.
    uint64_t bodies;
    // Joints and couplings at a time. Default 1 million.
    uint64_t joints;
    // Bytes of the geometry, and of the world. Default 1 GiB.
    uint64_t memory;
} BsReplayOptions;

// What came of a step of a replay, one of `BS_REPLAY_...`.
typedef uint32_t BsReplayProgress;

// Where in a step, one of `BS_STAGE_...`.
typedef uint32_t BsStage;

// The first difference between a replay and its recording.
typedef struct BsDivergence {
    // Size of this struct, set by the caller.
    uint32_t size;
    // The first stage with a different result.
    BsStage stage;
    // Which step, from 1; for a refused call, the step after it. Zero: no divergence, and all else is
    // zero.
    uint64_t step;
    // The first body that differs; all zeros if none shows it.
    struct BsBody body;
    // The caller's number of that body.
    uint64_t user_data;
    // How many bodies differ after the step.
    uint64_t bodies;
    // `bs_world_state_hash` after the step as recorded.
    uint64_t recorded_hash;
    // The same as replayed.
    uint64_t replayed_hash;
} BsDivergence;

// Counts and times of a step.
typedef struct BsStepReport {
    // Size of this struct, set by the caller.
    uint32_t size;
    // Time of the whole step [us].
    float step_us;
    // Time of forces, bounds and pairs [us].
    float broad_us;
    // Time of manifolds [us].
    float narrow_us;
    // Time of restitution, and of sorting, colouring and packing rows [us].
    float prepare_us;
    // Time of substeps [us].
    float solve_us;
    // Time of poses and the guard [us].
    float finish_us;
    // Pairs that the broad phase keeps.
    uint32_t pairs;
    // Movers whose box in the tree was renewed.
    uint32_t moved;
    // Movers that were swept along their path.
    uint32_t swept;
    // Manifolds with at least one point.
    uint32_t manifolds;
    // Points that touch.
    uint32_t real;
    // Points that may touch within the step.
    uint32_t potential;
    // Potential manifolds that had to push.
    uint32_t pushed;
    // Potential manifolds that pushed in the previous step without closing their gap: the body was pushed
    // by something that it never touched.
    uint32_t ghosts;
    // Pairs that kept their manifold without a new narrow phase.
    uint32_t recycled;
    // Fast pairs whose first touch within the step was searched for.
    uint32_t casts;
    // Points that bounced.
    uint32_t impacts;
    // Batches of eight manifolds.
    uint32_t batches;
    // Contacts that found no colour.
    uint32_t uncoloured;
    // Bodies whose path the guard cut: a centre, or the end of a limb, would have crossed something.
    uint32_t cut;
    // Bodies that crossed nothing, and that the guard lifted off a surface because they ended too close to
    // it.
    uint32_t lifted;
    // Bodies that rows pushed off their predicted path, and that would have entered or overlapped static
    // geometry: they were led along it, and ended outside of it.
    uint32_t settled;
    // Trees of joints in which a body counts as heavier than it is, because something more than 20,000
    // times as heavy is attached to it, or because hinges and welds turn more than 1,000 times its moment
    // of inertia with it: with its own mass the exact solution would lose its digits.
    uint32_t weighted_trees;
    // Trees of joints that whip, because a body bears several times its mass: no velocities at the start of
    // a substep leave them closed at its end, or only velocities that gain energy. They were closed all the
    // same, and lost some energy. Also nets of joints that turn faster than a substep can follow, if they
    // lost energy that their rows would have added.
    uint32_t damped_trees;
    // Bodies that had to be stopped, see `bs_world_faulted_bodies`.
    uint32_t faulted;
    // Impacts that were solved one by one at their times.
    uint32_t struck;
    // Bodies that lost the rest of the step after too many of those.
    uint32_t stood;
    // Bodies that are asleep.
    uint32_t asleep;
    // Bodies that fell asleep in the step, or since the one before.
    uint32_t slept;
    // Bodies that woke in the step, or since the one before.
    uint32_t woke;
    // Number of events beyond the capacity.
    uint32_t events_lost;
    // Points of contacts, and pairs with an unknown number of points, that were left out because memory was
    // not allowed to grow.
    uint32_t shed;
} BsStepReport;

// Bytes of one category.
typedef struct BsBytes {
    // In use now.
    uint64_t live;
    // Held, in use or not.
    uint64_t reserved;
    // The most that was ever reserved.
    uint64_t peak;
} BsBytes;

// Bytes of a world by category. Arrays of events that this interface hands out are not counted.
typedef struct BsMemoryReport {
    // Size of this struct, set by the caller.
    uint32_t size;
    // How many categories there are.
    uint32_t categories;
    // Reserved bytes of all.
    uint64_t total;
    // Bytes by `BS_CATEGORY_...`; zeros beyond those.
    struct BsBytes of[BS_CATEGORIES];
} BsMemoryReport;

// An optional part of the engine, and its cost in a world.
typedef struct BsFeatureCost {
    // Which: its place in the list, which a later version may add to at its end; `bs_feature_name` has its
    // name.
    uint32_t feature;
    // Number of objects that need it; zero if nothing does.
    uint32_t count;
    // Bytes that are reserved for it alone.
    uint64_t bytes;
    // Its time in the last step [us], where that is known.
    float time_us;
    // Whether the time is known.
    BsBool has_time;
    // Zero.
    uint8_t reserved[3];
} BsFeatureCost;

// The call did what it says.
#define BS_OK 0

// A pointer is null, or not aligned for what it points to.
#define BS_ERROR_NULL 1

// The `size` of a description is not one that any version of this header has had, or beyond this library's.
#define BS_ERROR_SIZE 2

// A buffer is too short. The number of elements that it needs was written, and nothing else.
#define BS_ERROR_BUFFER 3

// A number stands for none of the constants that it may be.
#define BS_ERROR_CONSTANT 4

// The object is in use by a call of another thread, or by the one whose callback this is.
#define BS_ERROR_BUSY 5

// A defect of this library: a call panicked, and what it had to change may be half done. If that was a
// world, all calls but `bs_world_restore` and `bs_world_destroy` return this until it is restored.
#define BS_ERROR_PANIC 6

// The body handle is stale: its body was removed.
#define BS_ERROR_STALE_BODY 7

// The shape handle is stale: its shape or its body was removed.
#define BS_ERROR_STALE_SHAPE 8

// The joint handle is stale: it broke, or it or one of its bodies was removed.
#define BS_ERROR_STALE_JOINT 9

// A number is NaN or infinite where it must not be.
#define BS_ERROR_NOT_FINITE 10

// A number is outside of its range.
#define BS_ERROR_OUT_OF_RANGE 11

// A list leaves something out.
#define BS_ERROR_INCOMPLETE 12

// Points that span no volume, an empty mesh and the like.
#define BS_ERROR_DEGENERATE 13

// A shape that only a static or kinematic body may have.
#define BS_ERROR_STATIC_ONLY 14

// A shape of a query that is not convex and bounded.
#define BS_ERROR_NOT_CONVEX 15

// A dynamic body without mass.
#define BS_ERROR_NO_MASS 16

// A joint of a body with itself.
#define BS_ERROR_JOINT_TO_ITSELF 17

// A joint without a dynamic body.
#define BS_ERROR_JOINT_OF_STILL 18

// Too many of something.
#define BS_ERROR_TOO_MANY 19

// The memory budget is exceeded.
#define BS_ERROR_BUDGET 20

// Bytes that are no snapshot, or no longer.
#define BS_ERROR_BROKEN_SNAPSHOT 21

// A snapshot of another version of its format.
#define BS_ERROR_SNAPSHOT_VERSION 22

// A snapshot refers to what the world does not have.
#define BS_ERROR_FOREIGN_SNAPSHOT 23

// Refused for a reason that this header has no code for; `bs_last_error` has its words.
#define BS_ERROR_OTHER 24

// The character handle is stale: its character was removed.
#define BS_ERROR_STALE_CHARACTER 25

// Not returned: a world that is being recorded can be restored.
#define BS_ERROR_RECORDED 26

// A target for a motor that the joint does not have.
#define BS_ERROR_NO_MOTOR 27

// Bytes that are no baked shape, or no longer.
#define BS_ERROR_BROKEN_SHAPE 28

// A baked shape of another version of its format.
#define BS_ERROR_SHAPE_VERSION 29

// The coupling handle is stale: it broke, or it or one of its joints was removed.
#define BS_ERROR_STALE_COUPLING 30

// A motion that cannot be coupled.
#define BS_ERROR_COUPLED_MOTION 31

// A world that is being recorded already, or is not being recorded.
#define BS_ERROR_RECORDING 32

// Bytes that are no recording, or no longer, or not all of it.
#define BS_ERROR_BROKEN_RECORDING 33

// A recording of another version of its format.
#define BS_ERROR_RECORDING_VERSION 34

// A recording asks for more than its limits allow.
#define BS_ERROR_LIMIT 35

// Three `double`s: in the world [m].
#define BS_POSITIONS_F64 0

// Three `float`s: relative to the world's origin [m].
#define BS_POSITIONS_F32 1

// Nothing: it has no velocity.
#define BS_BODY_STATIC 0

// Its velocity alone: it pushes and is not pushed.
#define BS_BODY_KINEMATIC 1

// Forces and contacts.
#define BS_BODY_DYNAMIC 2

// The x axis.
#define BS_AXIS_BIT_X 1

// The y axis.
#define BS_AXIS_BIT_Y 2

// The z axis.
#define BS_AXIS_BIT_Z 4

// A shape on a body.
#define BS_ELEMENT_SHAPE 0

// The box around a shape.
#define BS_ELEMENT_AABB 1

// The box that the broad phase keeps of it.
#define BS_ELEMENT_FAT_AABB 2

// The path that a swept body would have taken in the last step.
#define BS_ELEMENT_MOTION 3

// A point of contact that touched when the last step began.
#define BS_ELEMENT_REAL_POINT 4

// One that was apart then.
#define BS_ELEMENT_POTENTIAL_POINT 5

// A potential one that pushed although the shapes are apart after the step.
#define BS_ELEMENT_GHOST_POINT 6

// From one surface to the other at a point of contact.
#define BS_ELEMENT_GAP 7

// Normal at a point of contact, from the first shape to the second.
#define BS_ELEMENT_NORMAL 8

// Impulse at a point of contact.
#define BS_ELEMENT_IMPULSE 9

// An axis of a joint's frame.
#define BS_ELEMENT_JOINT_FRAME 10

// The range of a joint's limit.
#define BS_ELEMENT_JOINT_LIMIT 11

// From one frame of a joint to the other.
#define BS_ELEMENT_JOINT_GAP 12

// A body's centre of mass.
#define BS_ELEMENT_CENTRE_OF_MASS 13

// One of its principal axes of inertia.
#define BS_ELEMENT_PRINCIPAL_AXIS 14

// A contact, in the solver's colour.
#define BS_ELEMENT_SOLVER_COLOUR 15

// Something that this header has no name for.
#define BS_ELEMENT_OTHER 255

// [m]
#define BS_MOTION_LINEAR 0

// [rad]
#define BS_MOTION_ANGULAR 1

// Along or about x: a signed distance [m], or the twist [rad].
#define BS_AXIS_X 0

// Along or about y.
#define BS_AXIS_Y 1

// Along or about z.
#define BS_AXIS_Z 2

// The two others than x: the distance from the line along it [m], or the angle between the two frames' x, a
// cone [rad].
#define BS_AROUND_X 3

// The two others than y.
#define BS_AROUND_Y 4

// The two others than z.
#define BS_AROUND_Z 5

// The distance of the two frames [m], or the angle of the whole rotation between them [rad].
#define BS_AXES_ALL 6

// No spring: rigid. A motor must have one.
#define BS_SPRING_NONE 0

// Force or torque per displacement and per speed: [N/m] and [N s/m], or [N m/rad] and [N m s/rad]. Infinite
// damping holds the speed exactly.
#define BS_SPRING_COEFFICIENTS 1

// `stiffness` is the undamped frequency [Hz], `damping` the ratio: 1 is critical. Whatever the mass.
#define BS_SPRING_FREQUENCY 2

// Acceleration per displacement [1/s²] and per speed [1/s].
#define BS_SPRING_ACCELERATION 3

// Nothing.
#define BS_JOINT_FREE 0

// All motion.
#define BS_JOINT_FIXED 1

// The frames' origins stay together.
#define BS_JOINT_BALL 2

// Turns about the frames' x only.
#define BS_JOINT_HINGE 3

// Slides along the frames' x only.
#define BS_JOINT_SLIDER 4

// The frames' origins stay at a distance of `range_min` to `range_max` [m].
#define BS_JOINT_DISTANCE 5

// A wheel (second body) on a car (first): its hub moves along y by up to `range_max` [m] to either side,
// held by `spring`; it turns about x.
#define BS_JOINT_WHEEL 6

// Not at all.
#define BS_BONE_FIXED 0

// Within a cone of `swing`, with a twist of up to `twist` to either side.
#define BS_BONE_BALL 1

// About `axis`, from `min` to `max`.
#define BS_BONE_HINGE 2

// Poses, velocities, masses, handles.
#define BS_CATEGORY_BODIES 0

// Colliders, materials, convex hulls.
#define BS_CATEGORY_SHAPES 1

// Triangle meshes and height fields, with their trees.
#define BS_CATEGORY_MESHES 2

// Trees of the world, bounds, pairs.
#define BS_CATEGORY_BROAD_PHASE 3

// Contact manifolds and their impulses.
#define BS_CATEGORY_MANIFOLDS 4

// Solver rows in their batches.
#define BS_CATEGORY_ROWS 5

// Joints.
#define BS_CATEGORY_JOINTS 6

// Event buffers.
#define BS_CATEGORY_EVENTS 7

// Buffers of one step.
#define BS_CATEGORY_SCRATCH 8

// Memory that exists only because of continuous collision.
#define BS_CATEGORY_CONTINUOUS 9

// Collides at its current pose only: a fast body may pass through a thin one.
#define BS_CONTINUOUS_DISCRETE 0

// Collides along the segment of its motion within the step, whenever it leaves its margin.
#define BS_CONTINUOUS_SEGMENT 1

// Collides in the whole volume that it could reach within the step: more expensive; finds second impacts
// behind a first obstacle and crowds of fast bodies.
#define BS_CONTINUOUS_VOLUME 2

// In one pass with all other contacts, at the pose of first touch.
#define BS_METHOD_ONE_PASS 0

// Speculative contacts.
#define BS_METHOD_SPECULATIVE 1

// Sweeps after discrete contacts, straight ahead.
// Only in builds with the feature `methods`.
#define BS_METHOD_LINEAR_CAST 2

// The same with rotation, by conservative advancement.
// Only in builds with the feature `methods`.
#define BS_METHOD_CONSERVATIVE_ADVANCEMENT 3

// Speculative contacts behind two gates (Vincent Robert, GDC 2012).
// Only in builds with the feature `methods`.
#define BS_METHOD_TALK 4

// Coulomb's circular cone: the same friction in every direction.
#define BS_FRICTION_CONE 0

// A box per axis: cheaper, up to sqrt 2 too strong along its diagonal.
#define BS_FRICTION_BOX 1

// Once per manifold, at its centre, with a row against twist.
#define BS_FRICTION_PER_PATCH 0

// At every contact point.
#define BS_FRICTION_PER_POINT 1

// No group: the rows stay in their own place.
#define BS_ROWS_NONE 0

// Springs, motors and friction of joints.
#define BS_ROWS_SOFT_JOINTS 1

// Limits of joints.
#define BS_ROWS_JOINT_LIMITS 2

// Locked directions of joints.
#define BS_ROWS_JOINTS 3

// Contacts between two dynamic bodies.
#define BS_ROWS_CONTACTS 4

// Potential contacts between two dynamic bodies.
#define BS_ROWS_POTENTIAL_CONTACTS 5

// Contacts with static geometry.
#define BS_ROWS_STATIC_CONTACTS 6

// Potential contacts with static geometry.
#define BS_ROWS_POTENTIAL_STATIC_CONTACTS 7

// A ball around the origin, of `radius`.
#define BS_GEOMETRY_SPHERE 0

// The convex hull of two balls on the y axis, at `-half_height` with `radius` and at `half_height` with
// `radius_top`.
#define BS_GEOMETRY_CAPSULE 1

// A box around the origin, by `half_extents`.
#define BS_GEOMETRY_BOX 2

// A cylinder around the y axis, from `-half_height` with `radius` to `half_height` with `radius_top`: a
// frustum if they differ, a cone if one is zero.
#define BS_GEOMETRY_CYLINDER 3

// A convex `hull`.
#define BS_GEOMETRY_HULL 4

// The half-space y <= 0; only static or kinematic.
#define BS_GEOMETRY_PLANE 5

// Triangles, from both sides; only static or kinematic.
#define BS_GEOMETRY_MESH 6

// A grid of heights; only static or kinematic.
#define BS_GEOMETRY_HEIGHT_FIELD 7

// (a + b) / 2
#define BS_COMBINE_AVERAGE 0

// The smaller.
#define BS_COMBINE_MINIMUM 1

// The larger.
#define BS_COMBINE_MAXIMUM 2

// a b
#define BS_COMBINE_MULTIPLY 3

// Before the step: a call was refused that was not refused when it was recorded.
#define BS_STAGE_CALLS 0

// What the step starts with: poses, velocities, masses, accelerations.
#define BS_STAGE_FORCES 1

// Pairs.
#define BS_STAGE_BROAD 2

// Contacts.
#define BS_STAGE_NARROW 3

// Decisions of hooks, restitution, and the number of rows of each type.
#define BS_STAGE_PREPARE 4

// Velocities and displacements.
#define BS_STAGE_SOLVE 5

// Poses and velocities at the end, and which bodies fell asleep.
#define BS_STAGE_FINISH 6

// The same as in the recording.
#define BS_REPLAY_SAME 0

// It diverged.
#define BS_REPLAY_DIVERGED 1

// There is no further step: all of them were the same.
#define BS_REPLAY_END 2

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The interface's version of this library; a program that was built with a later header than the library
// finds a smaller number than its `BS_ABI_VERSION`.
BS_API uint32_t bs_abi_version(void);

// The version of the package, as `0.1.0`. Valid for ever.
BS_API const char *bs_version(void);

// The full message of this thread's last call that returned a status; empty if it succeeded. Valid until the
// next call of this thread that returns a status. UTF-8.
BS_API const char *bs_last_error(void);

// What a status means, in general; valid for ever. `bs_last_error` has the numbers.
BS_API const char *bs_error_text(BsStatus status);

// The convex hull of `count` points [m], in any order and with duplicates; at most 256 of them are kept as
// vertices.
BS_API BsStatus bs_hull_create(const struct BsVec3 *points, size_t count, const struct BsHull **hull);

// One more reference to a hull.
BS_API BsStatus bs_hull_retain(const struct BsHull *hull);

// One reference less. Null is no hull, and fine.
BS_API void bs_hull_release(const struct BsHull *hull);

// The vertices of a hull [m]. `count` becomes their number.
BS_API
BsStatus bs_hull_vertices(const struct BsHull *hull,
                          struct BsVec3 *vertices,
                          size_t capacity,
                          size_t *count);

// A mesh of `triangle_count` triangles, three indices of vertices each, counter-clockwise seen from the
// front. Equal vertices become one; triangles without area, or given twice, are dropped.
BS_API
BsStatus bs_mesh_create(const struct BsVec3 *vertices,
                        size_t vertex_count,
                        const uint32_t *indices,
                        size_t triangle_count,
                        const struct BsMesh **mesh);

// One more reference to a mesh.
BS_API BsStatus bs_mesh_retain(const struct BsMesh *mesh);

// One reference less. Null is no mesh, and fine.
BS_API void bs_mesh_release(const struct BsMesh *mesh);

// Number of triangles of a mesh: what is left of those that were given.
BS_API BsStatus bs_mesh_triangle_count(const struct BsMesh *mesh, size_t *count);

// The three corners of a triangle of a mesh [m], by the index that queries report.
BS_API BsStatus bs_mesh_corners(const struct BsMesh *mesh, uint32_t triangle, struct BsVec3 *corners);

// A field of `columns` times `rows` heights [m], row by row, with cells of `cell_x` along x and `cell_z`
// along z [m]. Its first sample is at its origin.
BS_API
BsStatus bs_height_field_create(size_t columns,
                                size_t rows,
                                float cell_x,
                                float cell_z,
                                const float *heights,
                                const struct BsHeightField **field);

// One more reference to a height field.
BS_API BsStatus bs_height_field_retain(const struct BsHeightField *field);

// One reference less. Null is no height field, and fine.
BS_API void bs_height_field_release(const struct BsHeightField *field);

// Number of triangles of a height field.
BS_API BsStatus bs_height_field_triangle_count(const struct BsHeightField *field, size_t *count);

// The three corners of a triangle of a height field [m], by the index that queries report.
BS_API
BsStatus bs_height_field_corners(const struct BsHeightField *field,
                                 uint32_t triangle,
                                 struct BsVec3 *corners);

// A mesh as by `bs_mesh_create`, with materials of its own: for each triangle zero for the material of the
// shape, or `i` for the table's entry `i - 1`, of at most 255. `surfaces` is what few materials have, or
// null.
BS_API
BsStatus bs_mesh_create_with_materials(const struct BsVec3 *vertices,
                                       size_t vertex_count,
                                       const uint32_t *indices,
                                       const uint8_t *numbers,
                                       size_t triangle_count,
                                       const struct BsMaterial *materials,
                                       const struct BsSurface *surfaces,
                                       size_t material_count,
                                       const struct BsMesh **mesh);

// A height field with materials of its cells, row by row, numbered as those of a mesh. The caller has a
// reference to the result.
BS_API
BsStatus bs_height_field_with_materials(const struct BsHeightField *field,
                                        const uint8_t *numbers,
                                        size_t cell_count,
                                        const struct BsMaterial *materials,
                                        const struct BsSurface *surfaces,
                                        size_t material_count,
                                        const struct BsHeightField **changed);

// The number of the material of a triangle, by the index that queries report; zero for that of the shape.
BS_API BsStatus bs_mesh_material_of(const struct BsMesh *mesh, uint32_t triangle, uint8_t *number);

// The number of the material of a triangle, by the index that queries report; zero for that of the shape.
BS_API
BsStatus bs_height_field_material_of(const struct BsHeightField *field,
                                     uint32_t triangle,
                                     uint8_t *number);

// How many materials the table of a mesh has.
BS_API BsStatus bs_mesh_material_count(const struct BsMesh *mesh, size_t *count);

// A material of the table of a mesh by its number, from one on; each pointer may be null.
BS_API
BsStatus bs_mesh_material(const struct BsMesh *mesh,
                          uint8_t number,
                          struct BsMaterial *material,
                          struct BsSurface *surface);

// How many materials the table of a height field has.
BS_API BsStatus bs_height_field_material_count(const struct BsHeightField *field, size_t *count);

// A material of the table of a height field by its number, from one on; each pointer may be null.
BS_API
BsStatus bs_height_field_material(const struct BsHeightField *field,
                                  uint8_t number,
                                  struct BsMaterial *material,
                                  struct BsSurface *surface);

// A height field with other holes: `columns` times `rows` cells from column `first_column` and row
// `first_row` on, row by row, each a hole or not. The caller has a reference to the result;
// `bs_shape_set_holes` changes the field of a shape in place.
BS_API
BsStatus bs_height_field_with_hole_map(const struct BsHeightField *field,
                                       size_t first_column,
                                       size_t first_row,
                                       size_t columns,
                                       size_t rows,
                                       const BsBool *holes,
                                       const struct BsHeightField **changed);

// A hull in another size, by a factor along each axis. The caller has a reference to it.
BS_API BsStatus bs_hull_scaled(const struct BsHull *hull, struct BsVec3 scale, const struct BsHull **scaled);

// A hull as bytes, which `bs_hull_from_bytes` reads without building it again. `count` becomes the number
// of bytes.
BS_API BsStatus bs_hull_to_bytes(const struct BsHull *hull, uint8_t *bytes, size_t capacity, size_t *count);

// A hull from bytes of `bs_hull_to_bytes`, which are checked. The caller has a reference to it.
BS_API BsStatus bs_hull_from_bytes(const uint8_t *bytes, size_t count, const struct BsHull **hull);

// A mesh in another size, by a factor along each axis. The caller has a reference to it.
BS_API BsStatus bs_mesh_scaled(const struct BsMesh *mesh, struct BsVec3 scale, const struct BsMesh **scaled);

// A mesh as bytes, which `bs_mesh_from_bytes` reads without building it again. `count` becomes the number
// of bytes.
BS_API BsStatus bs_mesh_to_bytes(const struct BsMesh *mesh, uint8_t *bytes, size_t capacity, size_t *count);

// A mesh from bytes of `bs_mesh_to_bytes`, which are checked. The caller has a reference to it.
BS_API BsStatus bs_mesh_from_bytes(const uint8_t *bytes, size_t count, const struct BsMesh **mesh);

// The low and the high corner of a mesh [m].
BS_API BsStatus bs_mesh_bounds(const struct BsMesh *mesh, struct BsVec3 *low, struct BsVec3 *high);

// A height field in another size, by a factor along each axis. The caller has a reference to it.
BS_API
BsStatus bs_height_field_scaled(const struct BsHeightField *field,
                                struct BsVec3 scale,
                                const struct BsHeightField **scaled);

// A height field as bytes, which `bs_height_field_from_bytes` reads without building it again. `count`
// becomes the number of bytes.
BS_API
BsStatus bs_height_field_to_bytes(const struct BsHeightField *field,
                                  uint8_t *bytes,
                                  size_t capacity,
                                  size_t *count);

// A height field from bytes of `bs_height_field_to_bytes`, which are checked. The caller has a reference to
// it.
BS_API
BsStatus bs_height_field_from_bytes(const uint8_t *bytes,
                                    size_t count,
                                    const struct BsHeightField **field);

// The low and the high corner of a height field [m].
BS_API
BsStatus bs_height_field_bounds(const struct BsHeightField *field,
                                struct BsVec3 *low,
                                struct BsVec3 *high);

// How far the furthest given point is outside of a hull [m]: within rounding, unless its vertices were too
// many.
BS_API BsStatus bs_hull_left_out(const struct BsHull *hull, float *distance);

// The faces of a hull: for each the number of its vertices, in `sizes`, and their indices one after another
// in `indices`, counter-clockwise seen from outside. The counts become the numbers of both.
BS_API
BsStatus bs_hull_faces(const struct BsHull *hull,
                       uint16_t *sizes,
                       size_t size_capacity,
                       size_t *size_count,
                       uint16_t *indices,
                       size_t index_capacity,
                       size_t *index_count);

// A height field without `count` of its cells: what falls there falls through. `cells` has a column and a
// row for each, two numbers. The caller has a reference to the result.
BS_API
BsStatus bs_height_field_with_holes(const struct BsHeightField *field,
                                    const size_t *cells,
                                    size_t count,
                                    const struct BsHeightField **holed);

// Whether a cell of a height field is a hole; no beyond the last.
BS_API
BsStatus bs_height_field_is_hole(const struct BsHeightField *field,
                                 size_t column,
                                 size_t row,
                                 BsBool *hole);

// A height field with other heights [m]: `columns` times `rows` samples from column `first_column` and row
// `first_row` on, row by row. The caller has a reference to the result; `bs_shape_set_heights` changes the
// field of a shape in place.
BS_API
BsStatus bs_height_field_with_heights(const struct BsHeightField *field,
                                      size_t first_column,
                                      size_t first_row,
                                      size_t columns,
                                      size_t rows,
                                      const float *heights,
                                      const struct BsHeightField **changed);

// Adds a body.
BS_API BsStatus bs_world_add_body(struct BsWorld *world, const struct BsBodyDesc *desc, struct BsBody *body);

// Adds many bodies: all of them, or none. `bodies` has `count` places, or is null.
BS_API
BsStatus bs_world_add_bodies(struct BsWorld *world,
                             const struct BsBodyDesc *descs,
                             size_t count,
                             struct BsBody *bodies);

// Removes a body with its shapes and joints.
BS_API BsStatus bs_world_remove_body(struct BsWorld *world, struct BsBody body);

// Removes many bodies: all of them, or none.
BS_API BsStatus bs_world_remove_bodies(struct BsWorld *world, const struct BsBody *bodies, size_t count);

// All bodies: first dynamic ones, then kinematic ones, then those that sleep or are disabled, then static
// ones. `count` becomes their number.
BS_API
BsStatus bs_world_bodies(const struct BsWorld *world,
                         struct BsBody *bodies,
                         size_t capacity,
                         size_t *count);

// Whether a handle is that of a body of the world; no if there is no such world.
BS_API BsBool bs_world_contains_body(const struct BsWorld *world, struct BsBody body);

// What moves a body.
BS_API BsStatus bs_body_kind(const struct BsWorld *world, struct BsBody body, BsBodyKind *kind);

// The caller's number of a body.
BS_API BsStatus bs_body_user_data(const struct BsWorld *world, struct BsBody body, uint64_t *user_data);

// Disables a body, or enables it again, with its shapes and joints. A disabled body does not move, touches
// nothing and is invisible to queries.
BS_API BsStatus bs_body_set_enabled(struct BsWorld *world, struct BsBody body, BsBool enabled);

// Whether a body takes part in the world.
BS_API BsStatus bs_body_is_enabled(const struct BsWorld *world, struct BsBody body, BsBool *enabled);

// Sets the factor on gravity, within 1e6.
BS_API BsStatus bs_body_set_gravity_scale(struct BsWorld *world, struct BsBody body, float scale);

// Sets how a body is kept from passing through others.
BS_API BsStatus bs_body_set_continuous(struct BsWorld *world, struct BsBody body, BsContinuousMode mode);

// Has the rows of a body solved right after those of a group, or in their own place again.
BS_API BsStatus bs_body_set_solved_after(struct BsWorld *world, struct BsBody body, BsRowGroup group);

// Pose of a body's origin in the world.
BS_API BsStatus bs_body_pose(const struct BsWorld *world, struct BsBody body, struct BsPose *pose);

// Position of a body's origin relative to the world's origin [m], in single precision.
BS_API
BsStatus bs_body_local_position(const struct BsWorld *world,
                                struct BsBody body,
                                struct BsVec3 *position);

// Moves a body to a pose at once.
BS_API BsStatus bs_body_set_pose(struct BsWorld *world, struct BsBody body, struct BsPose pose);

// Velocity of a body's centre of mass [m/s] and about the world's axes [rad/s]; each pointer may be null.
BS_API
BsStatus bs_body_velocity(const struct BsWorld *world,
                          struct BsBody body,
                          struct BsVec3 *linear,
                          struct BsVec3 *angular);

// Sets linear [m/s] and angular [rad/s] velocity. Has no effect on a static body.
BS_API
BsStatus bs_body_set_velocity(struct BsWorld *world,
                              struct BsBody body,
                              struct BsVec3 linear,
                              struct BsVec3 angular);

// Gives a kinematic body the velocity that takes its origin to a pose within the next step of `dt` seconds.
// In the steps after it moves on with that velocity: call it before each step, or
// `bs_body_move_kinematic_and_stop`.
BS_API
BsStatus bs_body_move_kinematic(struct BsWorld *world,
                                struct BsBody body,
                                struct BsPose pose,
                                float dt);

// The same, but in the steps after the body stands where it was told to be, until it is moved again.
BS_API
BsStatus bs_body_move_kinematic_and_stop(struct BsWorld *world,
                                         struct BsBody body,
                                         struct BsPose pose,
                                         float dt);

// Adds a force [N] at the centre of mass and a torque [N m] to a dynamic body, for the next step. Forces and
// impulses on other bodies have no effect.
BS_API
BsStatus bs_body_add_force_and_torque(struct BsWorld *world,
                                      struct BsBody body,
                                      struct BsVec3 force,
                                      struct BsVec3 torque);

// Adds a force [N] at the centre of mass of a dynamic body, for the next step.
BS_API BsStatus bs_body_add_force(struct BsWorld *world, struct BsBody body, struct BsVec3 force);

// Adds a torque [N m] to a dynamic body, for the next step.
BS_API BsStatus bs_body_add_torque(struct BsWorld *world, struct BsBody body, struct BsVec3 torque);

// Changes the linear velocity of a dynamic body by an impulse [N s] at its centre of mass.
BS_API BsStatus bs_body_apply_impulse(struct BsWorld *world, struct BsBody body, struct BsVec3 impulse);

// Changes the velocities of a dynamic body by an impulse [N s] at a point of the world [m].
BS_API
BsStatus bs_body_apply_impulse_at(struct BsWorld *world,
                                  struct BsBody body,
                                  struct BsVec3 impulse,
                                  struct BsDVec3 point);

// Whether a body is asleep.
BS_API BsStatus bs_body_is_sleeping(const struct BsWorld *world, struct BsBody body, BsBool *asleep);

// Wakes a body and its island.
BS_API BsStatus bs_body_wake(struct BsWorld *world, struct BsBody body);

// Puts a dynamic body to sleep with all that it touches or is joined to. Does nothing if sleeping is off.
BS_API BsStatus bs_body_sleep(struct BsWorld *world, struct BsBody body);

// Sets whether a body may fall asleep.
BS_API BsStatus bs_body_set_can_sleep(struct BsWorld *world, struct BsBody body, BsBool can_sleep);

// No columns.
BS_API struct BsColumns bs_columns_default(void);

// Writes poses and velocities of `count` bodies into columns, in their order; `bodies` null: of all bodies,
// in the order of `bs_world_bodies`, of which there must be `count`. If a handle is stale nothing is
// written.
BS_API
BsStatus bs_world_read_bodies(const struct BsWorld *world,
                              const struct BsBody *bodies,
                              size_t count,
                              const struct BsColumns *into);

// Makes a body static, kinematic or dynamic; it keeps its handle, pose, shapes and joints.
BS_API BsStatus bs_body_set_kind(struct BsWorld *world, struct BsBody body, BsBodyKind kind);

// Sets the caller's number of a body.
BS_API BsStatus bs_body_set_user_data(struct BsWorld *world, struct BsBody body, uint64_t user_data);

// Factor on gravity.
BS_API BsStatus bs_body_gravity_scale(const struct BsWorld *world, struct BsBody body, float *scale);

// Linear and angular damping [1/s]; each pointer may be null.
BS_API
BsStatus bs_body_damping(const struct BsWorld *world,
                         struct BsBody body,
                         float *linear,
                         float *angular);

// Sets linear and angular damping, at least zero [1/s]: velocity decays as exp(-c t).
BS_API BsStatus bs_body_set_damping(struct BsWorld *world, struct BsBody body, float linear, float angular);

// Caps on linear [m/s] and angular speed [rad/s], infinity for none; each pointer may be null.
BS_API
BsStatus bs_body_max_speeds(const struct BsWorld *world,
                            struct BsBody body,
                            float *linear,
                            float *angular);

// Caps linear [m/s] and angular speed [rad/s], above zero; infinity for no cap.
BS_API
BsStatus bs_body_set_max_speeds(struct BsWorld *world,
                                struct BsBody body,
                                float linear,
                                float angular);

// World axes along which a body can't move, and about which it can't turn, as bits of `BS_AXIS_BIT_...`;
// each pointer may be null.
BS_API
BsStatus bs_body_locked_axes(const struct BsWorld *world,
                             struct BsBody body,
                             BsAxes *translation,
                             BsAxes *rotation);

// Locks world axes, as bits of `BS_AXIS_BIT_...`.
BS_API
BsStatus bs_body_set_locked_axes(struct BsWorld *world,
                                 struct BsBody body,
                                 BsAxes translation,
                                 BsAxes rotation);

// How a body is kept from passing through others.
BS_API BsStatus bs_body_continuous(const struct BsWorld *world, struct BsBody body, BsContinuousMode *mode);

// The group after which the rows of a body are solved, or `BS_ROWS_NONE`.
BS_API BsStatus bs_body_solved_after(const struct BsWorld *world, struct BsBody body, BsRowGroup *group);

// Whether a body may fall asleep.
BS_API BsStatus bs_body_can_sleep(const struct BsWorld *world, struct BsBody body, BsBool *can_sleep);

// Sets the linear velocity alone [m/s].
BS_API BsStatus bs_body_set_linear_velocity(struct BsWorld *world, struct BsBody body, struct BsVec3 linear);

// Sets the angular velocity alone [rad/s].
BS_API
BsStatus bs_body_set_angular_velocity(struct BsWorld *world,
                                      struct BsBody body,
                                      struct BsVec3 angular);

// Velocity of a body at a point of the world [m], as if the point were fixed to it [m/s].
BS_API
BsStatus bs_body_velocity_at(const struct BsWorld *world,
                             struct BsBody body,
                             struct BsDVec3 point,
                             struct BsVec3 *velocity);

// Adds a force [N] at a point of the world [m] to a dynamic body, for the next step.
BS_API
BsStatus bs_body_add_force_at(struct BsWorld *world,
                              struct BsBody body,
                              struct BsVec3 force,
                              struct BsDVec3 point);

// Changes the angular velocity of a dynamic body by an angular impulse [N m s].
BS_API
BsStatus bs_body_apply_angular_impulse(struct BsWorld *world,
                                       struct BsBody body,
                                       struct BsVec3 impulse);

// Mass, centre and inertia of a body; without mass for static and kinematic bodies.
BS_API
BsStatus bs_body_mass_properties(const struct BsWorld *world,
                                 struct BsBody body,
                                 struct BsMassProperties *mass);

// Whether the mass of a body follows from its shapes.
BS_API
BsStatus bs_body_has_mass_from_shapes(const struct BsWorld *world,
                                      struct BsBody body,
                                      BsBool *from_shapes);

// Contacts of a body in the last step, with shapes that it touched or that pushed it. Sensors have none.
// `count` becomes their number.
BS_API
BsStatus bs_body_contacts(const struct BsWorld *world,
                          struct BsBody body,
                          struct BsContact *contacts,
                          size_t capacity,
                          size_t *count);

// All contacts of the last step, each once. `count` becomes their number.
BS_API
BsStatus bs_world_contacts(const struct BsWorld *world,
                           struct BsContact *contacts,
                           size_t capacity,
                           size_t *count);

// Awake dynamic bodies. `count` becomes their number.
BS_API
BsStatus bs_world_awake_bodies(const struct BsWorld *world,
                               struct BsBody *bodies,
                               size_t capacity,
                               size_t *count);

// Bodies that the last step moved, with their poses and velocities: dynamic ones that are awake, then
// kinematic ones with a velocity, then dynamic ones that fell asleep, once. To be called after a step, and
// before other calls change bodies. Allocates nothing. `count` becomes their number.
BS_API
BsStatus bs_world_body_moves(const struct BsWorld *world,
                             struct BsBodyMove *moves,
                             size_t capacity,
                             size_t *count);

// The joints of a body. `count` becomes their number.
BS_API
BsStatus bs_body_joints(const struct BsWorld *world,
                        struct BsBody body,
                        struct BsJoint *joints,
                        size_t capacity,
                        size_t *count);

// The box around all shapes of a body. `found` becomes whether it has shapes; if not, the box is as it was.
BS_API
BsStatus bs_body_aabb(const struct BsWorld *world,
                      struct BsBody body,
                      struct BsAabb *aabb,
                      BsBool *found);

// A dynamic body at the origin, at rest, without shapes.
BS_API struct BsBodyDesc bs_body_desc_default(void);

// A character of 1.8 m and 80 kg.
BS_API struct BsCharacterSettings bs_character_settings_default(void);

// A character whose capsule has its middle at a point [m]. `settings` may be null: the defaults. It belongs
// to no world: each walk says in which.
BS_API
BsStatus bs_character_create(const struct BsCharacterSettings *settings,
                             struct BsDVec3 position,
                             struct BsCharacter **character);

// Destroys a character. Null is none, and fine.
BS_API void bs_character_destroy(struct BsCharacter *character);

// Moves with a velocity [m/s] for `dt` [s], as far as obstacles allow. On ground the velocity is relative to
// it, in the air it is that in the world; gravity is the caller's to add. `filter` may be null, `report`
// too.
BS_API
BsStatus bs_character_walk(struct BsCharacter *character,
                           const struct BsWorld *world,
                           const struct BsQueryFilter *filter,
                           struct BsVec3 velocity,
                           float dt,
                           struct BsCharacterReport *report);

// The report of the last walk.
BS_API BsStatus bs_character_report(const struct BsCharacter *character, struct BsCharacterReport *report);

// What the last walk ran into, in order, up to eight. `count` becomes their number.
BS_API
BsStatus bs_character_hits(const struct BsCharacter *character,
                           struct BsCharacterHit *hits,
                           size_t capacity,
                           size_t *count);

// Pushes the dynamic bodies that the last walk ran into, and puts the character's weight on the one that it
// stands on.
BS_API BsStatus bs_character_push(const struct BsCharacter *character, struct BsWorld *world);

// Where the middle of the capsule is, and the ground under a character on level ground [m]; each pointer may
// be null.
BS_API
BsStatus bs_character_position(const struct BsCharacter *character,
                               struct BsDVec3 *middle,
                               struct BsDVec3 *feet);

// Puts a character somewhere else at once [m], on nothing.
BS_API BsStatus bs_character_set_position(struct BsCharacter *character, struct BsDVec3 position);

// The settings of a character.
BS_API
BsStatus bs_character_settings(const struct BsCharacter *character,
                               struct BsCharacterSettings *settings);

// Replaces the settings, to crouch or to grow; its middle stays where it is.
BS_API
BsStatus bs_character_set_settings(struct BsCharacter *character,
                                   const struct BsCharacterSettings *settings);

// Its capsule without the skin, and how that is turned: for queries, or for a kinematic body of its own.
BS_API
BsStatus bs_character_capsule(const struct BsCharacter *character,
                              struct BsGeometry *capsule,
                              struct BsQuat *rotation);

// Gives a character a shape of its own, any convex one, or with null the capsule of its settings again. Its
// y axis is along `up`, its origin at the character's position, which stays; `radius` and `half_height` of
// the settings then mean nothing.
BS_API BsStatus bs_character_set_shape(struct BsCharacter *character, const struct BsGeometry *shape);

// The shape of a character without the skin, its own or its capsule, and how that is turned in the world. A
// hull in it is the character's: retain it to keep it.
BS_API
BsStatus bs_character_shape(const struct BsCharacter *character,
                            struct BsGeometry *shape,
                            struct BsQuat *rotation);

// Turns a character's own shape from upright at once, in axes whose y is `up`; a capsule is not turned.
BS_API BsStatus bs_character_set_rotation(struct BsCharacter *character, struct BsQuat rotation);

// The rotation of a character's own shape from upright.
BS_API BsStatus bs_character_rotation(const struct BsCharacter *character, struct BsQuat *rotation);

// What a character stood on after its last walk, `on_ground` 0 if on nothing: all else is then zero.
BS_API
BsStatus bs_character_ground(const struct BsCharacter *character,
                             struct BsGround *ground,
                             BsBool *on_ground);

// Puts a copy of a character into a world, where `bs_world_walk_character` moves it. Bodies don't notice it.
// `added` may be null.
BS_API
BsStatus bs_world_add_character(struct BsWorld *world,
                                const struct BsCharacter *character,
                                struct BsWorldCharacter *added);

// Removes a character from a world.
BS_API BsStatus bs_world_remove_character(struct BsWorld *world, struct BsWorldCharacter character);

// Makes `copy` what a character of a world is now: to read its settings, shape, position and ground. It has
// no report.
BS_API
BsStatus bs_world_character(const struct BsWorld *world,
                            struct BsWorldCharacter character,
                            struct BsCharacter *copy);

// Replaces a character of a world: to place it somewhere else, to give it other settings or another shape.
BS_API
BsStatus bs_world_set_character(struct BsWorld *world,
                                struct BsWorldCharacter character,
                                const struct BsCharacter *to);

// `bs_character_walk` of a character of the world. `filter` may be null, `report` too, and `copy` as well,
// which becomes the character after the walk and has its report: for `bs_character_hits` and
// `bs_character_push`. What a predicate asks of this world is refused with `BS_ERROR_BUSY`.
BS_API
BsStatus bs_world_walk_character(struct BsWorld *world,
                                 struct BsWorldCharacter character,
                                 const struct BsQueryFilter *filter,
                                 struct BsVec3 velocity,
                                 float dt,
                                 struct BsCharacterReport *report,
                                 struct BsCharacter *copy);

// The characters of a world, by handle. `count` becomes their number.
BS_API
BsStatus bs_world_characters(const struct BsWorld *world,
                             struct BsWorldCharacter *characters,
                             size_t capacity,
                             size_t *count);

// Shapes, points of contact and joints.
BS_API struct BsDrawOptions bs_draw_options_default(void);

// Functions that draw nothing.
BS_API struct BsDrawCalls bs_draw_calls_default(void);

// Draws what the options ask for, through the caller's functions. `options` may be null: the defaults.
BS_API
BsStatus bs_world_draw(const struct BsWorld *world,
                       const struct BsDrawOptions *options,
                       const struct BsDrawCalls *calls);

// Draws what the options ask for as lines and points, into arrays. The counts become their numbers; if
// either buffer is too short, nothing else is written.
BS_API
BsStatus bs_world_draw_arrays(const struct BsWorld *world,
                              const struct BsDrawOptions *options,
                              struct BsLine *lines,
                              size_t line_capacity,
                              size_t *line_count,
                              struct BsPoint *points,
                              size_t point_capacity,
                              size_t *point_count);

// Pairs that began to touch in the last step, of which one shape asks for events. The array is valid until
// the world is next stepped, restored or destroyed.
BS_API
BsStatus bs_world_contact_begins(const struct BsWorld *world,
                                 const struct BsContactEvent **events,
                                 size_t *count);

// Pairs that no longer touch since the last step. The array is valid until the world is next stepped,
// restored or destroyed.
BS_API
BsStatus bs_world_contact_ends(const struct BsWorld *world,
                               const struct BsContactEnd **events,
                               size_t *count);

// Pairs that hit each other in the last step, at `BsSettings::hit_speed` or faster. The array is valid until
// the world is next stepped, restored or destroyed.
BS_API
BsStatus bs_world_contact_hits(const struct BsWorld *world,
                               const struct BsContactEvent **events,
                               size_t *count);

// Shapes that entered sensors in the last step. The array is valid until the world is next stepped, restored
// or destroyed.
BS_API
BsStatus bs_world_sensor_begins(const struct BsWorld *world,
                                const struct BsSensorEvent **events,
                                size_t *count);

// Shapes that left sensors in the last step. The array is valid until the world is next stepped, restored or
// destroyed.
BS_API
BsStatus bs_world_sensor_ends(const struct BsWorld *world,
                              const struct BsSensorEvent **events,
                              size_t *count);

// Joints that broke in the last step; their handles are stale. The array is valid until the world is next
// stepped, restored or destroyed.
BS_API
BsStatus bs_world_broken_joints(const struct BsWorld *world,
                                const struct BsJoint **joints,
                                size_t *count);

// The shapes that are in a sensor as of the last step, in the order of their handles.
BS_API
BsStatus bs_sensor_overlaps(const struct BsWorld *world,
                            struct BsShape sensor,
                            struct BsShape *visitors,
                            size_t capacity,
                            size_t *count);

// Adds a joint. `joint` may be null.
BS_API
BsStatus bs_world_add_joint(struct BsWorld *world,
                            const struct BsJointDesc *desc,
                            struct BsJoint *joint);

// Adds many joints: all of them, or none. `joints` has `count` places, or is null.
BS_API
BsStatus bs_world_add_joints(struct BsWorld *world,
                             const struct BsJointDesc *descs,
                             size_t count,
                             struct BsJoint *joints);

// Removes a joint.
BS_API BsStatus bs_world_remove_joint(struct BsWorld *world, struct BsJoint joint);

// Whether a handle is that of a joint of the world; no if there is no such world.
BS_API BsBool bs_world_contains_joint(const struct BsWorld *world, struct BsJoint joint);

// Replaces the limits and motors of a joint by those of a description: its kind with `range_min`,
// `range_max` and `spring`, its limits and its motors. Nothing else of the description is read.
BS_API BsStatus bs_joint_set(struct BsWorld *world, struct BsJoint joint, const struct BsJointDesc *desc);

// Frames on two bodies that coincide at the bodies' current poses, at a point of the world [m], with the
// axes that a rotation gives x, y and z. `frames` has two places.
BS_API
BsStatus bs_joint_frames_at(const struct BsWorld *world,
                            struct BsBody a,
                            struct BsBody b,
                            struct BsDVec3 point,
                            struct BsQuat rotation,
                            struct BsFrame *frames);

// Frames on two bodies that coincide at the bodies' current poses, at a point of the world [m], whose x axes
// are along an axis of the world of any length: a hinge turns about it. `frames` has two places.
BS_API
BsStatus bs_joint_frames_about(const struct BsWorld *world,
                               struct BsBody a,
                               struct BsBody b,
                               struct BsDVec3 point,
                               struct BsVec3 axis,
                               struct BsFrame *frames);

// Poses of a joint's two frames in the world. `poses` has two places.
BS_API BsStatus bs_joint_frames(const struct BsWorld *world, struct BsJoint joint, struct BsPose *poses);

// The two bodies of a joint. `bodies` has two places.
BS_API BsStatus bs_joint_bodies(const struct BsWorld *world, struct BsJoint joint, struct BsBody *bodies);

// Force [N] and torque [N m] of a joint on its second body in the last substep, in world axes; the first
// body gets the opposite. Each pointer may be null.
BS_API
BsStatus bs_joint_force(const struct BsWorld *world,
                        struct BsJoint joint,
                        struct BsVec3 *force,
                        struct BsVec3 *torque);

// Has the rows of a joint solved right after those of a group, or in their own place again.
BS_API BsStatus bs_joint_set_solved_after(struct BsWorld *world, struct BsJoint joint, BsRowGroup group);

// The caller's number of a joint.
BS_API BsStatus bs_joint_user_data(const struct BsWorld *world, struct BsJoint joint, uint64_t *user_data);

// Replaces the motor of a joint with the same motion and axis, or adds it.
BS_API
BsStatus bs_joint_set_motor(struct BsWorld *world,
                            struct BsJoint joint,
                            const struct BsMotorDesc *motor);

// Removes the motor of a joint with a motion and an axis. `removed` becomes whether there was one; it may be
// null.
BS_API
BsStatus bs_joint_remove_motor(struct BsWorld *world,
                               struct BsJoint joint,
                               BsMotion motion,
                               BsJointAxes axis,
                               BsBool *removed);

// Sets the targets of a motor: a position [m] or [rad] and a velocity [m/s] or [rad/s]. Meant for every
// step.
BS_API
BsStatus bs_joint_set_target(struct BsWorld *world,
                             struct BsJoint joint,
                             BsMotion motion,
                             BsJointAxes axis,
                             float position,
                             float velocity);

// Replaces the limit of a joint with the same motion and axes, or adds it.
BS_API
BsStatus bs_joint_set_limit(struct BsWorld *world,
                            struct BsJoint joint,
                            const struct BsLimitDesc *limit);

// Removes the limit of a joint with a motion and axes. `removed` becomes whether there was one; it may be
// null.
BS_API
BsStatus bs_joint_remove_limit(struct BsWorld *world,
                               struct BsJoint joint,
                               BsMotion motion,
                               BsJointAxes axes,
                               BsBool *removed);

// The limits of a joint, those of its kind among them. `count` becomes their number.
BS_API
BsStatus bs_joint_limits(const struct BsWorld *world,
                         struct BsJoint joint,
                         struct BsLimitDesc *limits,
                         size_t capacity,
                         size_t *count);

// The motors of a joint. `count` becomes their number.
BS_API
BsStatus bs_joint_motors(const struct BsWorld *world,
                         struct BsJoint joint,
                         struct BsMotorDesc *motors,
                         size_t capacity,
                         size_t *count);

// Displacement of a joint along or about axes [m] or [rad], as its limits measure it.
BS_API
BsStatus bs_joint_position(const struct BsWorld *world,
                           struct BsJoint joint,
                           BsMotion motion,
                           BsJointAxes axes,
                           float *displacement);

// Speed of a joint along or about an axis [m/s] or [rad/s].
BS_API
BsStatus bs_joint_velocity(const struct BsWorld *world,
                           struct BsJoint joint,
                           BsMotion motion,
                           BsJointAxes axis,
                           float *speed);

// Where a joint sits on its two bodies, in their axes. `frames` has two places.
BS_API
BsStatus bs_joint_local_frames(const struct BsWorld *world,
                               struct BsJoint joint,
                               struct BsFrame *frames);

// Moves a joint on its two bodies. `frames` has two elements.
BS_API
BsStatus bs_joint_set_frames(struct BsWorld *world,
                             struct BsJoint joint,
                             const struct BsFrame *frames);

// Whether the two bodies of a joint collide with each other.
BS_API BsStatus bs_joint_collide(const struct BsWorld *world, struct BsJoint joint, BsBool *collide);

// Sets whether the two bodies of a joint collide with each other.
BS_API BsStatus bs_joint_set_collide(struct BsWorld *world, struct BsJoint joint, BsBool collide);

// Force [N] and torque [N m] above which a joint breaks; each pointer may be null.
BS_API
BsStatus bs_joint_break_force(const struct BsWorld *world,
                              struct BsJoint joint,
                              float *force,
                              float *torque);

// Sets force [N] and torque [N m] above which a joint breaks; infinity for never.
BS_API
BsStatus bs_joint_set_break_force(struct BsWorld *world,
                                  struct BsJoint joint,
                                  float force,
                                  float torque);

// Force [N] and torque [N m] above which a joint is in `bs_world_strained_joints`; each pointer may be null.
BS_API
BsStatus bs_joint_thresholds(const struct BsWorld *world,
                             struct BsJoint joint,
                             float *force,
                             float *torque);

// Sets force [N] and torque [N m] above which a joint is in `bs_world_strained_joints`; infinity for never.
BS_API
BsStatus bs_joint_set_thresholds(struct BsWorld *world,
                                 struct BsJoint joint,
                                 float force,
                                 float torque);

// Sets the caller's number of a joint.
BS_API BsStatus bs_joint_set_user_data(struct BsWorld *world, struct BsJoint joint, uint64_t user_data);

// Joints that bore more than one of their thresholds in the last step, in the order of their slots. `count`
// becomes their number.
BS_API
BsStatus bs_world_strained_joints(const struct BsWorld *world,
                                  struct BsStrainedJoint *joints,
                                  size_t capacity,
                                  size_t *count);

// Keeps the sum of two motions at what it is.
BS_API
struct BsCouplingDesc bs_coupling_desc_default(struct BsCoupledMotion first,
                                               struct BsCoupledMotion second);

// Two meshing gears on hinges about the frames' x, by their numbers of teeth. A negative number, for one of
// the two, makes them turn alike.
BS_API
struct BsCouplingDesc bs_coupling_desc_gear(struct BsJoint first,
                                            struct BsJoint second,
                                            double first_teeth,
                                            double second_teeth);

// A pinion on a hinge and a rack on a slider, both along the frames' x: by one turn the rack travels
// 2 pi `radius` [m].
BS_API
struct BsCouplingDesc bs_coupling_desc_rack(struct BsJoint hinge,
                                            struct BsJoint slider,
                                            double radius);

// A screw: by one turn about the frames' x of a joint that leaves both free, it travels `lead` [m] along it.
BS_API struct BsCouplingDesc bs_coupling_desc_screw(struct BsJoint joint, double lead);

// A rope over two pulleys: the distance of the first joint's frames and `ratio` times that of the second's
// are together at most `length` [m].
BS_API
struct BsCouplingDesc bs_coupling_desc_pulley(struct BsJoint first,
                                              struct BsJoint second,
                                              double ratio,
                                              double length);

// Adds a coupling of two motions of joints. `coupling` may be null.
BS_API
BsStatus bs_world_add_coupling(struct BsWorld *world,
                               const struct BsCouplingDesc *desc,
                               struct BsCoupling *coupling);

// Removes a coupling.
BS_API BsStatus bs_world_remove_coupling(struct BsWorld *world, struct BsCoupling coupling);

// The displacements of a coupling's two motions [m] or [rad], with whole turns; each pointer may be null.
BS_API
BsStatus bs_coupling_positions(const struct BsWorld *world,
                               struct BsCoupling coupling,
                               double *first,
                               double *second);

// The sum that a coupling keeps: of both displacements times their factors.
BS_API BsStatus bs_coupling_sum(const struct BsWorld *world, struct BsCoupling coupling, double *sum);

// What a coupling exerted on each of its motions in the last substep [N] or [N m]; each pointer may be null.
BS_API
BsStatus bs_coupling_force(const struct BsWorld *world,
                           struct BsCoupling coupling,
                           float *first,
                           float *second);

// Sets the factors of a coupling where its motions are: shifts a gear.
BS_API
BsStatus bs_coupling_set_factors(struct BsWorld *world,
                                 struct BsCoupling coupling,
                                 double first,
                                 double second);

// Sets the range of a coupling's sum, infinite for no end.
BS_API
BsStatus bs_coupling_set_range(struct BsWorld *world,
                               struct BsCoupling coupling,
                               double min,
                               double max);

// Couplings that broke in the last step; their handles are stale. `count` becomes their number.
BS_API
BsStatus bs_world_broken_couplings(const struct BsWorld *world,
                                   struct BsCoupling *couplings,
                                   size_t capacity,
                                   size_t *count);

// Makes a coupling keep its sum at what it is, instead of within a range.
BS_API BsStatus bs_coupling_keep(struct BsWorld *world, struct BsCoupling coupling);

// Sets what a coupling breaks at on each of its motions [N] or [N m], infinite for never.
BS_API
BsStatus bs_coupling_set_break_force(struct BsWorld *world,
                                     struct BsCoupling coupling,
                                     float first,
                                     float second);

// Sets the caller's number of a coupling.
BS_API
BsStatus bs_coupling_set_user_data(struct BsWorld *world,
                                   struct BsCoupling coupling,
                                   uint64_t user_data);

// A coupling as it is now, into a description whose `size` says how much of it the caller knows. It always
// has a range, of no width if it keeps its sum.
BS_API
BsStatus bs_coupling_desc(const struct BsWorld *world,
                          struct BsCoupling coupling,
                          struct BsCouplingDesc *desc);

// Whether a handle is that of a coupling of the world; no if there is no such world.
BS_API BsBool bs_world_contains_coupling(const struct BsWorld *world, struct BsCoupling coupling);

// Number of couplings of a world.
BS_API BsStatus bs_world_coupling_count(const struct BsWorld *world, size_t *count);

// Couplings of a motion of a joint. `count` becomes their number.
BS_API
BsStatus bs_joint_couplings(const struct BsWorld *world,
                            struct BsJoint joint,
                            struct BsCoupling *couplings,
                            size_t capacity,
                            size_t *count);

// A rigid limit.
BS_API struct BsLimitDesc bs_limit_desc(BsMotion motion, BsJointAxes axes, float min, float max);

// Holds a speed [m/s] or [rad/s] with at most so much force [N] or torque [N m]; friction at speed zero.
BS_API struct BsMotorDesc bs_motor_desc(BsMotion motion, BsJointAxes axis, float velocity, float max_force);

// A spring towards a position [m] or [rad].
BS_API
struct BsMotorDesc bs_spring_desc(BsMotion motion,
                                  BsJointAxes axis,
                                  float position,
                                  struct BsSpring spring);

// A joint of a kind between the origins of two bodies.
BS_API struct BsJointDesc bs_joint_desc_default(BsJointKind kind, struct BsBody a, struct BsBody b);

// A solid that is turned and then moved [m], as from a shape's frame into its body's.
BS_API
BsStatus bs_mass_transformed(struct BsMassProperties mass,
                             struct BsVec3 position,
                             struct BsQuat rotation,
                             struct BsMassProperties *out);

// Several solids as one.
BS_API
BsStatus bs_mass_combined(const struct BsMassProperties *parts,
                          size_t count,
                          struct BsMassProperties *out);

// Mass of a body [kg]; zero for static and kinematic bodies.
BS_API BsStatus bs_body_mass(const struct BsWorld *world, struct BsBody body, float *mass);

// Replaces the mass of a body; from now on it does not follow from the shapes.
BS_API BsStatus bs_body_set_mass(struct BsWorld *world, struct BsBody body, struct BsMassProperties mass);

// Position of a body's centre of mass in the world [m].
BS_API
BsStatus bs_body_centre_of_mass(const struct BsWorld *world,
                                struct BsBody body,
                                struct BsDVec3 *centre);

// All shapes but sensors.
BS_API struct BsQueryFilter bs_query_filter_default(void);

// The first shape that a ray meets; `hit->hit` says whether there is one. `filter` may be null: all but
// sensors.
BS_API
BsStatus bs_world_cast_ray(const struct BsWorld *world,
                           struct BsRay ray,
                           const struct BsQueryFilter *filter,
                           struct BsHit *hit);

// Whether a ray meets anything at all.
BS_API
BsStatus bs_world_cast_ray_any(const struct BsWorld *world,
                               struct BsRay ray,
                               const struct BsQueryFilter *filter,
                               BsBool *any);

// All shapes that a ray meets, each where it is met first, by fraction. `count` becomes their number.
BS_API
BsStatus bs_world_cast_ray_all(const struct BsWorld *world,
                               struct BsRay ray,
                               const struct BsQueryFilter *filter,
                               struct BsHit *hits,
                               size_t capacity,
                               size_t *count);

// The first shapes that many rays meet: the answer to `rays[i]` goes to `hits[i]`. Faster than one by one
// where neighbours go about the same way.
BS_API
BsStatus bs_world_cast_rays(const struct BsWorld *world,
                            const struct BsRay *rays,
                            size_t count,
                            const struct BsQueryFilter *filter,
                            struct BsHit *hits);

// The first shape that a convex one touches that moves from a pose along a path [m]; `hit->hit` says whether
// there is one.
BS_API
BsStatus bs_world_cast_shape(const struct BsWorld *world,
                             const struct BsGeometry *shape,
                             struct BsPose pose,
                             struct BsVec3 path,
                             const struct BsQueryFilter *filter,
                             struct BsHit *hit);

// Whether a moving shape touches anything at all.
BS_API
BsStatus bs_world_cast_shape_any(const struct BsWorld *world,
                                 const struct BsGeometry *shape,
                                 struct BsPose pose,
                                 struct BsVec3 path,
                                 const struct BsQueryFilter *filter,
                                 BsBool *any);

// All shapes that a moving one would touch if none stopped it, by fraction. With a path of zero: all that it
// overlaps, with depths. `count` becomes their number.
BS_API
BsStatus bs_world_cast_shape_all(const struct BsWorld *world,
                                 const struct BsGeometry *shape,
                                 struct BsPose pose,
                                 struct BsVec3 path,
                                 const struct BsQueryFilter *filter,
                                 struct BsHit *hits,
                                 size_t capacity,
                                 size_t *count);

// The shape that is nearest to a point [m], within a distance [m]; `closest->found` says whether there is
// one.
BS_API
BsStatus bs_world_closest_point(const struct BsWorld *world,
                                struct BsDVec3 point,
                                float distance,
                                const struct BsQueryFilter *filter,
                                struct BsClosestPoint *closest);

// Whether any shape is within a distance [m] of a point [m]; inside counts.
BS_API
BsStatus bs_world_closest_point_any(const struct BsWorld *world,
                                    struct BsDVec3 point,
                                    float distance,
                                    const struct BsQueryFilter *filter,
                                    BsBool *any);

// The nearest point of every shape within a distance [m], by distance. `count` becomes their number.
BS_API
BsStatus bs_world_closest_point_all(const struct BsWorld *world,
                                    struct BsDVec3 point,
                                    float distance,
                                    const struct BsQueryFilter *filter,
                                    struct BsClosestPoint *points,
                                    size_t capacity,
                                    size_t *count);

// A shape that moves from a pose along a path [m] and does not turn.
BS_API
struct BsShapeCast bs_shape_cast_default(const struct BsGeometry *shape,
                                         struct BsPose pose,
                                         struct BsVec3 path);

// A shape that moves from one pose to another: its origin straight, its rotation the shorter way about one
// axis. The rotations are unit quaternions.
BS_API
struct BsShapeCast bs_shape_cast_between(const struct BsGeometry *shape,
                                         struct BsPose from,
                                         struct BsPose to);

// The first shape that one touches that moves and turns; `hit->hit` says whether there is one.
BS_API
BsStatus bs_world_cast_turning(const struct BsWorld *world,
                               const struct BsShapeCast *cast,
                               const struct BsQueryFilter *filter,
                               struct BsHit *hit);

// Whether a shape that moves and turns touches anything at all.
BS_API
BsStatus bs_world_cast_turning_any(const struct BsWorld *world,
                                   const struct BsShapeCast *cast,
                                   const struct BsQueryFilter *filter,
                                   BsBool *any);

// All shapes that one would touch that moves and turns if none stopped it, by fraction. `count` becomes
// their number.
BS_API
BsStatus bs_world_cast_turning_all(const struct BsWorld *world,
                                   const struct BsShapeCast *cast,
                                   const struct BsQueryFilter *filter,
                                   struct BsHit *hits,
                                   size_t capacity,
                                   size_t *count);

// Where the shape of a cast is at a fraction of its way.
BS_API BsStatus bs_shape_cast_pose(const struct BsShapeCast *cast, float fraction, struct BsPose *pose);

// All shapes that a convex one at a pose overlaps or touches, by handle. `count` becomes their number.
BS_API
BsStatus bs_world_overlap(const struct BsWorld *world,
                          const struct BsGeometry *shape,
                          struct BsPose pose,
                          const struct BsQueryFilter *filter,
                          struct BsOverlap *overlaps,
                          size_t capacity,
                          size_t *count);

// All shapes whose boxes meet a box along the axes of the world, by their handles: a cheap first choice of
// what may be there. `count` becomes their number.
BS_API
BsStatus bs_world_overlap_aabb(const struct BsWorld *world,
                               struct BsAabb area,
                               const struct BsQueryFilter *filter,
                               struct BsOverlap *overlaps,
                               size_t capacity,
                               size_t *count);

// Whether a convex shape at a pose overlaps or touches anything.
BS_API
BsStatus bs_world_overlap_any(const struct BsWorld *world,
                              const struct BsGeometry *shape,
                              struct BsPose pose,
                              const struct BsQueryFilter *filter,
                              BsBool *any);

// A root without length, which is refused.
BS_API struct BsBoneDesc bs_bone_desc_default(void);

// A skeleton of ordinary flesh without bones.
BS_API struct BsSkeletonDesc bs_skeleton_desc_default(void);

// The bones of a figure of 1.85 m with spread arms that stands at the origin and looks along z: pelvis,
// torso and head, and upper and lower arms and legs. `count` becomes their number.
BS_API BsStatus bs_humanoid_bones(struct BsBoneDesc *bones, size_t capacity, size_t *count);

// Adds a skeleton that stands somewhere, turned, and moves [m/s]: a body for each bone, and a joint for each
// that has a parent, in their order. `bodies` has a place for each bone; `joints` has `joint_capacity` of
// them, and `joint_count` becomes their number.
BS_API
BsStatus bs_world_add_ragdoll(struct BsWorld *world,
                              const struct BsSkeletonDesc *desc,
                              struct BsPose pose,
                              struct BsVec3 velocity,
                              struct BsBody *bodies,
                              struct BsJoint *joints,
                              size_t joint_capacity,
                              size_t *joint_count);

// Adds a skeleton as `bs_world_add_ragdoll` does, and keeps what `bs_ragdoll_drive_to` needs.
BS_API
BsStatus bs_ragdoll_create(struct BsWorld *world,
                           const struct BsSkeletonDesc *desc,
                           struct BsPose pose,
                           struct BsVec3 velocity,
                           struct BsRagdoll **ragdoll);

// Destroys what `bs_ragdoll_create` keeps. Null is none, and fine.
BS_API void bs_ragdoll_destroy(struct BsRagdoll *ragdoll);

// The bodies of a ragdoll, one a bone. `count` becomes their number.
BS_API
BsStatus bs_ragdoll_bodies(const struct BsRagdoll *ragdoll,
                           struct BsBody *bodies,
                           size_t capacity,
                           size_t *count);

// The joints of a ragdoll, one for each bone but the roots. `count` becomes their number.
BS_API
BsStatus bs_ragdoll_joints(const struct BsRagdoll *ragdoll,
                           struct BsJoint *joints,
                           size_t capacity,
                           size_t *count);

// Drives the joints of a ragdoll to a pose, by a spring about each axis that a joint turns about with at
// most so much torque [N m], in the place of the friction there: with each frame of an animation.
// `rotations` has `count` of them, for each bone from where it is in the skeleton, in the skeleton's axes.
// Nothing holds the figure as a whole. Joints that broke are left out.
BS_API
BsStatus bs_ragdoll_drive_to(const struct BsRagdoll *ragdoll,
                             struct BsWorld *world,
                             const struct BsQuat *rotations,
                             size_t count,
                             struct BsSpring spring,
                             float max_torque);

// Takes the springs of `bs_ragdoll_drive_to` away: the figure is limp again, with the friction of its
// skeleton.
BS_API BsStatus bs_ragdoll_relax(const struct BsRagdoll *ragdoll, struct BsWorld *world);

// The name of a category of memory; empty for none. Valid for ever.
BS_API const char *bs_category_name(BsCategory category);

// The name of a part of the engine by its number; empty for none. Valid for ever.
BS_API const char *bs_feature_name(uint32_t feature);

// The settings that a world has if nobody says anything else.
BS_API struct BsSettings bs_settings_default(void);

// A ball [m].
BS_API struct BsGeometry bs_sphere(float radius);

// A capsule along y [m]; it tapers if the radii differ.
BS_API struct BsGeometry bs_capsule(float half_height, float radius, float radius_top);

// A box by its half extents [m].
BS_API struct BsGeometry bs_box(float x, float y, float z);

// A cylinder along y [m]; a frustum if the radii differ, a cone if one is zero.
BS_API struct BsGeometry bs_cylinder(float half_height, float radius, float radius_top);

// The half-space y <= 0.
BS_API struct BsGeometry bs_plane(void);

// A hull. The geometry has no reference of its own.
BS_API struct BsGeometry bs_hull(const struct BsHull *hull);

// A mesh. The geometry has no reference of its own.
BS_API struct BsGeometry bs_mesh(const struct BsMesh *mesh);

// A height field. The geometry has no reference of its own.
BS_API struct BsGeometry bs_height_field(const struct BsHeightField *field);

// Friction 0.6 and no restitution.
BS_API struct BsMaterial bs_material_default(void);

// Collides with everything.
BS_API struct BsFilter bs_filter_default(void);

// A shape at the body's origin with default material, filter and density.
BS_API struct BsShapeDesc bs_shape_desc_default(struct BsGeometry geometry);

// Adds a shape to a body. `shape` may be null.
BS_API
BsStatus bs_body_add_shape(struct BsWorld *world,
                           struct BsBody body,
                           const struct BsShapeDesc *desc,
                           struct BsShape *shape);

// Removes a shape from its body.
BS_API BsStatus bs_shape_remove(struct BsWorld *world, struct BsShape shape);

// The shapes of a body. `count` becomes their number.
BS_API
BsStatus bs_body_shapes(const struct BsWorld *world,
                        struct BsBody body,
                        struct BsShape *shapes,
                        size_t capacity,
                        size_t *count);

// The form of a shape. Its pointer, if it has one, is valid until the shape is gone, unless it is retained.
BS_API
BsStatus bs_shape_geometry(const struct BsWorld *world,
                           struct BsShape shape,
                           struct BsGeometry *geometry);

// Friction and restitution of a shape.
BS_API
BsStatus bs_shape_material(const struct BsWorld *world,
                           struct BsShape shape,
                           struct BsMaterial *material);

// Replaces friction and restitution of a shape; its surface stays.
BS_API
BsStatus bs_shape_set_material(struct BsWorld *world,
                               struct BsShape shape,
                               struct BsMaterial material);

// Replaces the filter of a shape.
BS_API BsStatus bs_shape_set_filter(struct BsWorld *world, struct BsShape shape, struct BsFilter filter);

// Sets whether contacts of a shape are reported as events.
BS_API BsStatus bs_shape_set_events(struct BsWorld *world, struct BsShape shape, BsBool events);

// Makes a shape a sensor, or solid again.
BS_API BsStatus bs_shape_set_sensor(struct BsWorld *world, struct BsShape shape, BsBool sensor);

// The caller's number of a shape.
BS_API BsStatus bs_shape_user_data(const struct BsWorld *world, struct BsShape shape, uint64_t *user_data);

// Mass, centre and inertia of a solid of a form and an even density [kg/m³].
BS_API
BsStatus bs_geometry_mass(const struct BsGeometry *geometry,
                          float density,
                          struct BsMassProperties *mass);

// Triangles that show a form, in its own frame [m], three corners each, counter-clockwise from outside.
// `count` becomes the number of corners.
BS_API
BsStatus bs_geometry_triangles(const struct BsGeometry *geometry,
                               struct BsVec3 *corners,
                               size_t capacity,
                               size_t *count);

// The body of a shape.
BS_API BsStatus bs_shape_body(const struct BsWorld *world, struct BsShape shape, struct BsBody *body);

// Which shapes a shape collides with.
BS_API BsStatus bs_shape_filter(const struct BsWorld *world, struct BsShape shape, struct BsFilter *filter);

// Whether contacts of a shape are reported as events.
BS_API BsStatus bs_shape_has_events(const struct BsWorld *world, struct BsShape shape, BsBool *events);

// Whether a shape is a sensor.
BS_API BsStatus bs_shape_is_sensor(const struct BsWorld *world, struct BsShape shape, BsBool *sensor);

// Whether a shape as a sensor also notices what is static.
BS_API
BsStatus bs_shape_senses_static(const struct BsWorld *world,
                                struct BsShape shape,
                                BsBool *senses_static);

// Whether a shape as a sensor also notices static shapes, and surfaces of meshes and height fields.
BS_API BsStatus bs_shape_set_senses_static(struct BsWorld *world, struct BsShape shape, BsBool senses_static);

// Sets the caller's number of a shape.
BS_API BsStatus bs_shape_set_user_data(struct BsWorld *world, struct BsShape shape, uint64_t user_data);

// Friction of a shape against rolling and spinning, its belt and its spring.
BS_API
BsStatus bs_shape_surface(const struct BsWorld *world,
                          struct BsShape shape,
                          struct BsSurface *surface);

// Replaces friction of a shape against rolling and spinning, its belt and its spring; the rest of its
// material stays.
BS_API BsStatus bs_shape_set_surface(struct BsWorld *world, struct BsShape shape, struct BsSurface surface);

// Replaces the form of a shape. Mass follows if it is that of the shapes.
BS_API
BsStatus bs_shape_set_geometry(struct BsWorld *world,
                               struct BsShape shape,
                               const struct BsGeometry *geometry);

// Where the frame of a shape is in its body's [m], and how it is turned; each pointer may be null.
BS_API
BsStatus bs_shape_pose(const struct BsWorld *world,
                       struct BsShape shape,
                       struct BsVec3 *position,
                       struct BsQuat *rotation);

// Moves a shape on its body [m]. Mass follows if it is that of the shapes.
BS_API
BsStatus bs_shape_set_pose(struct BsWorld *world,
                           struct BsShape shape,
                           struct BsVec3 position,
                           struct BsQuat rotation);

// Where the frame of a shape is in the world.
BS_API BsStatus bs_shape_world_pose(const struct BsWorld *world, struct BsShape shape, struct BsPose *pose);

// Density of a shape [kg/m³].
BS_API BsStatus bs_shape_density(const struct BsWorld *world, struct BsShape shape, float *density);

// Replaces the density of a shape [kg/m³]. Mass follows if it is that of the shapes.
BS_API BsStatus bs_shape_set_density(struct BsWorld *world, struct BsShape shape, float density);

// The box around a shape, along the axes of the world.
BS_API BsStatus bs_shape_aabb(const struct BsWorld *world, struct BsShape shape, struct BsAabb *aabb);

// Changes heights of a height field [m]: `columns` times `rows` samples from column `first_column` and row
// `first_row` on, row by row. What is near wakes; what would be below the surface is lifted above it. Other
// shapes that share the field keep theirs.
BS_API
BsStatus bs_shape_set_heights(struct BsWorld *world,
                              struct BsShape shape,
                              size_t first_column,
                              size_t first_row,
                              size_t columns,
                              size_t rows,
                              const float *heights);

// Cuts cells out of a height field, or fills them: `columns` times `rows` cells from column `first_column`
// and row `first_row` on, row by row, each a hole or not. What is near wakes; what is in a cell that is
// filled, and has its centre above the surface, is lifted. Other shapes that share the field keep theirs.
BS_API
BsStatus bs_shape_set_holes(struct BsWorld *world,
                            struct BsShape shape,
                            size_t first_column,
                            size_t first_row,
                            size_t columns,
                            size_t rows,
                            const BsBool *holes);

// An empty snapshot, to be filled by `bs_world_snapshot`, again and again without new memory.
BS_API BsStatus bs_snapshot_create(struct BsSnapshot **snapshot);

// Destroys a snapshot. Null is none, and fine.
BS_API void bs_snapshot_destroy(struct BsSnapshot *snapshot);

// Writes the state of the world into a snapshot.
BS_API BsStatus bs_world_snapshot(const struct BsWorld *world, struct BsSnapshot *snapshot);

// Takes the world back to the time of a snapshot: its next steps give the same bits as then, with any number
// of threads. What was added since is removed, what was removed is back with the same handles. Threads,
// budget and reports stay as they are. A world that a panic broke is whole again.
BS_API BsStatus bs_world_restore(struct BsWorld *world, const struct BsSnapshot *snapshot);

// Bytes of the state, and of the parts that snapshots of the same content share; each pointer may be null.
BS_API BsStatus bs_snapshot_size(const struct BsSnapshot *snapshot, size_t *own, size_t *shared);

// The state as bytes, for a world that has the same bodies, shapes and joints by the same calls. `count`
// becomes the number of bytes.
BS_API
BsStatus bs_snapshot_to_bytes(const struct BsSnapshot *snapshot,
                              uint8_t *bytes,
                              size_t capacity,
                              size_t *count);

// The state and what snapshots share as bytes, for any world that has the same hulls, meshes and height
// fields on some of its shapes. All other content of that world goes when it is restored.
BS_API
BsStatus bs_snapshot_to_whole_bytes(const struct BsSnapshot *snapshot,
                                    uint8_t *bytes,
                                    size_t capacity,
                                    size_t *count);

// A snapshot from bytes of `bs_snapshot_to_bytes` or `bs_snapshot_to_whole_bytes`. Whether it fits a world
// is checked when it is restored.
BS_API BsStatus bs_snapshot_from_bytes(const uint8_t *bytes, size_t count, struct BsSnapshot **snapshot);

// Records every call that changes a world from here on, until `bs_world_stop_recording`; of a world that is
// not new with what it is now, and each `bs_world_restore` as it was. Queries change nothing and are not
// recorded.
BS_API BsStatus bs_world_start_recording(struct BsWorld *world);

// Ends the recording of a world. `steps`, `calls` and `bytes` become the numbers of what is in it; each may
// be null. `bs_world_recording` has the bytes.
BS_API
BsStatus bs_world_stop_recording(struct BsWorld *world,
                                 uint64_t *steps,
                                 uint64_t *calls,
                                 uint64_t *bytes);

// Whether a world is being recorded.
BS_API BsStatus bs_world_is_recording(const struct BsWorld *world, BsBool *recording);

// The bytes of a world's last recording, complete once it was stopped: `bs_replay_create` plays them, and a
// file of them is one that the command `backstop replay` plays. `count` becomes their number, zero if there
// never was a recording.
BS_API
BsStatus bs_world_recording(const struct BsWorld *world,
                            uint8_t *bytes,
                            size_t capacity,
                            size_t *count);

// Gives a body a name in the recording, if there is one: which `bs_replay_divergence` tells. UTF-8, ends
// with a zero.
BS_API BsStatus bs_world_name_recorded(struct BsWorld *world, struct BsBody body, const char *name);

// As it was recorded, within generous limits.
BS_API struct BsReplayOptions bs_replay_options_default(void);

// A replay of `count` bytes of a recording, which are copied, before its first step. `options` may be null:
// the defaults.
BS_API
BsStatus bs_replay_create(const uint8_t *bytes,
                          size_t count,
                          const struct BsReplayOptions *options,
                          struct BsReplay **replay);

// Destroys a replay. Null is none, and fine.
BS_API void bs_replay_destroy(struct BsReplay *replay);

// Plays all calls up to the next step, and that. A replay that diverged stays where it is.
BS_API BsStatus bs_replay_step(struct BsReplay *replay, BsReplayProgress *progress);

// Plays on to the end, or to the first divergence: `progress` becomes which of them.
BS_API BsStatus bs_replay_run(struct BsReplay *replay, BsReplayProgress *progress);

// Where a replay diverged, and in words if `text` is not null: valid until the replay is played on or
// destroyed, and empty if it did not diverge.
BS_API
BsStatus bs_replay_divergence(const struct BsReplay *replay,
                              struct BsDivergence *divergence,
                              const char **text);

// Number of steps that a replay has played, the hash of its world, and the version of backstop that
// recorded, valid until the replay is destroyed; each pointer may be null.
BS_API
BsStatus bs_replay_state(const struct BsReplay *replay,
                         uint64_t *steps,
                         uint64_t *hash,
                         const char **engine);

// Writes the state of a replay's world into a snapshot: a world that restores it goes on from there.
BS_API BsStatus bs_replay_snapshot(const struct BsReplay *replay, struct BsSnapshot *snapshot);

// An empty world. `settings` may be null: the defaults.
BS_API BsStatus bs_world_create(const struct BsSettings *settings, struct BsWorld **world);

// Destroys a world; its handles mean nothing any more. Null is no world, and fine. No other call may use it
// meanwhile or after.
BS_API void bs_world_destroy(struct BsWorld *world);

// Moves the world on by `dt` seconds, 1e-6 to 10. Events and reports are then those of this step.
BS_API BsStatus bs_world_step(struct BsWorld *world, float dt);

// The settings. `settings->size` says how much of them is wanted.
BS_API BsStatus bs_world_settings(const struct BsWorld *world, struct BsSettings *settings);

// Replaces the settings; the next step uses them.
BS_API BsStatus bs_world_set_settings(struct BsWorld *world, const struct BsSettings *settings);

// The point that single-precision positions are relative to [m].
BS_API BsStatus bs_world_origin(const struct BsWorld *world, struct BsDVec3 *origin);

// Moves the point that single-precision positions are relative to [m]. Bodies stay where they are.
BS_API BsStatus bs_world_set_origin(struct BsWorld *world, struct BsDVec3 origin);

// Hash of all poses and velocities, bit by bit: the same on every machine for the same calls.
BS_API BsStatus bs_world_state_hash(const struct BsWorld *world, uint64_t *hash);

// Kinetic energy of all dynamic bodies plus their potential energy in the world's gravity [J].
BS_API BsStatus bs_world_energy(const struct BsWorld *world, double *energy);

// Counts and times of the last step. `report->size` says how much of it is wanted.
BS_API BsStatus bs_world_report(const struct BsWorld *world, struct BsStepReport *report);

// Bytes that the world holds, by category. `report->size` says how much of it is wanted.
BS_API BsStatus bs_world_memory(const struct BsWorld *world, struct BsMemoryReport *report);

// The optional parts of the engine that the world's content needs, and their cost, by their numbers.
// `count` becomes the number of parts.
BS_API
BsStatus bs_world_feature_report(const struct BsWorld *world,
                                 struct BsFeatureCost *parts,
                                 size_t capacity,
                                 size_t *count);

// Bodies that the last step had to stop, because their motion was no number or out of range.
BS_API
BsStatus bs_world_faulted_bodies(const struct BsWorld *world,
                                 struct BsBody *bodies,
                                 size_t capacity,
                                 size_t *count);

// Numbers of bodies and joints, and of bodies and islands that are asleep; each pointer may be null.
BS_API
BsStatus bs_world_counts(const struct BsWorld *world,
                         size_t *bodies,
                         size_t *joints,
                         size_t *sleeping_bodies,
                         size_t *sleeping_islands);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* BACKSTOP_H */

// Names of version 1: all of them say centre.
#define bs_body_center_of_mass bs_body_centre_of_mass
#define BS_ELEMENT_CENTER_OF_MASS BS_ELEMENT_CENTRE_OF_MASS
