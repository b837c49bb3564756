//! The layout of every struct is pinned: what a program was built with is what a later library finds. The
//! numbers are those that gcc gave for the header on x86-64; tests/layout.awk hands them to the C compiler,
//! which checks them too.

#![cfg(target_pointer_width = "64")]

use backstop_c::*;
use std::mem::offset_of;

macro_rules! pinned {
    ($name:ident, $size:literal, $align:literal, [$($field:ident $at:literal),* $(,)?]) => {
        assert_eq!((size_of::<$name>(), align_of::<$name>()), ($size, $align), stringify!($name));
        $(assert_eq!(offset_of!($name, $field), $at, concat!(stringify!($name), ".", stringify!($field)));)*
    };
}

#[test]
fn values_and_shapes_are_where_they_were() {
    pinned!(BsVec3, 12, 4, [
        x 0, y 4, z 8,
    ]);
    pinned!(BsDVec3, 24, 8, [
        x 0, y 8, z 16,
    ]);
    pinned!(BsQuat, 16, 4, [
        x 0, y 4, z 8, w 12,
    ]);
    pinned!(BsGeometry, 56, 8, [
        kind 0, half_height 4, radius 8, radius_top 12, half_extents 16, reserved 28, hull 32, mesh 40,
        height_field 48,
    ]);
    pinned!(BsMaterial, 24, 4, [
        static_friction 0, dynamic_friction 4, restitution 8, friction_combine 12,
        restitution_combine 16, reserved 20,
    ]);
    pinned!(BsFilter, 24, 8, [
        category 0, mask 8, group 16, reserved 20,
    ]);
    pinned!(BsShapeDesc, 184, 8, [
        size 0, sensor 4, events 5, senses_static 6, reserved 7, geometry 8, position 64, rotation 76,
        density 92,
        material 96, filter 120, user_data 144,
        surface 152,
    ]);
    pinned!(BsMassProperties, 52, 4, [
        mass 0, centre_of_mass 4, inertia 16,
    ]);
    pinned!(BsBody, 8, 4, [
        slot 0, generation 4,
    ]);
    pinned!(BsPose, 40, 8, [
        position 0, rotation 24,
    ]);
    pinned!(BsShape, 8, 4, [
        slot 0, generation 4,
    ]);
    pinned!(BsJoint, 8, 4, [
        slot 0, generation 4,
    ]);
}

#[test]
fn content_are_where_they_were() {
    pinned!(BsBodyDesc, 136, 8, [
        size 0, kind 4, position 8, rotation 32, linear_velocity 48, angular_velocity 60, shapes 72,
        shape_count 80, mass 88, gravity_scale 96, continuous 100, solved_after 104,
        lock_translation 108, lock_rotation 109, can_sleep 110, reserved 111, user_data 112,
        linear_damping 120, angular_damping 124, max_linear_speed 128, max_angular_speed 132,
    ]);
    pinned!(BsSpring, 12, 4, [
        kind 0, stiffness 4, damping 8,
    ]);
    pinned!(BsLimitDesc, 32, 4, [
        size 0, motion 4, axes 8, min 12, max 16, spring 20,
    ]);
    pinned!(BsMotorDesc, 36, 4, [
        size 0, motion 4, axis 8, position 12, velocity 16, spring 20, max_force 32,
    ]);
    pinned!(BsFrame, 28, 4, [
        position 0, rotation 12,
    ]);
    pinned!(BsJointDesc, 168, 8, [
        size 0, kind 4, bodies 8, frames 24, range_min 80, range_max 84, spring 88, break_force 100,
        break_torque 104, solved_after 108, collide 112, reserved 113, limits 120, limit_count 128,
        motors 136, motor_count 144, user_data 152,
        force_threshold 160, torque_threshold 164,
    ]);
    pinned!(BsBoneDesc, 80, 4, [
        size 0, parent 4, joint_at 8, from 20, to 32, radius 44, joint 48, swing 52, twist 56, axis 60,
        min 72, max 76,
    ]);
    pinned!(BsSkeletonDesc, 112, 8, [
        size 0, density 4, bones 8, bone_count 16, material 24, filter 48, friction 72, reserved 76,
        surface 80,
    ]);
}

#[test]
fn reports_are_where_they_were() {
    pinned!(BsCharacterSettings, 52, 4, [
        size 0, radius 4, half_height 8, skin 12, max_slope 16, step_height 20, snap 24, iterations 28,
        up 32, mass 44, strength 48,
    ]);
    pinned!(BsGround, 64, 8, [
        body 0, shape 8, point 16, normal 40, velocity 52,
    ]);
    pinned!(BsCharacterReport, 160, 8, [
        size 0, stepped 4, position 8, moved 32, carried 44, pushed_out 56, velocity 68, turned 80,
        overlap 84, ground 88, on_ground 152, reserved 153,
    ]);
    pinned!(BsCharacterHit, 64, 8, [
        body 0, shape 8, point 16, normal 40, impulse 52,
    ]);
    pinned!(BsContactEvent, 80, 8, [
        shapes 0, bodies 16, point 32, normal 56, approach_speed 68, impulse 72, reserved 76,
    ]);
    pinned!(BsContactEnd, 16, 4, [
        shapes 0,
    ]);
    pinned!(BsSensorEvent, 20, 4, [
        sensor 0, visitor 8, fraction 16,
    ]);
    pinned!(BsSettings, 264, 8, [
        size 0, gravity 4, substeps 16, iterations 20, threads 24, continuous 28, continuous_method 32,
        friction_cone 36, friction_model 40, length_unit 44, restitution_threshold 48, slop 52,
        contact_hertz 56, contact_damping 60, push_speed 64, warm_starting 68, recycling 69,
        joint_trees 70, guard 71, sleeping 72, reserved 73, sleep_speed 80, sleep_time 84, hit_speed 88,
        event_capacity 92, order 96, budget 128, budget_of 136,
    ]);
    pinned!(BsStepReport, 132, 4, [
        size 0, step_us 4, broad_us 8, narrow_us 12, prepare_us 16, solve_us 20, finish_us 24, pairs 28,
        moved 32, swept 36, manifolds 40, real 44, potential 48, pushed 52, ghosts 56, recycled 60,
        casts 64, impacts 68, batches 72, uncoloured 76, cut 80, lifted 84, settled 88,
        weighted_trees 92, damped_trees 96, faulted 100, struck 104, stood 108, asleep 112, slept 116,
        woke 120, events_lost 124, shed 128,
    ]);
    pinned!(BsBytes, 24, 8, [
        live 0, reserved 8, peak 16,
    ]);
    pinned!(BsMemoryReport, 400, 8, [
        size 0, categories 4, total 8, of 16,
    ]);
    pinned!(BsFeatureCost, 24, 8, [
        feature 0, count 4, bytes 8, time_us 16, has_time 20, reserved 21,
    ]);
}

#[test]
fn queries_and_drawing_are_where_they_were() {
    pinned!(BsColumns, 56, 8, [
        size 0, position_type 4, positions 8, rotations 16, linear_velocities 24, angular_velocities 32,
        position_stride 40, rotation_stride 44, linear_stride 48, angular_stride 52,
    ]);
    pinned!(BsQueryFilter, 88, 8, [
        size 0, statics 4, kinematic 5, dynamic 6, sensors 7, skip_inside 8, has_filter 9, reserved 10,
        filter 16, exclude_body 40, exclude_shape 48, predicate 56, user 64,
        only_body 72, only_shape 80,
    ]);
    pinned!(BsDrawOptions, 72, 8, [
        size 0, shapes 4, aabbs 5, fat_aabbs 6, motion 7, contacts 8, normals 9, impulses 10, joints 11,
        islands 12, centres 13, solver_colours 14, has_region 15, region_min 16, region_max 40,
        length 64, impulse_scale 68,
    ]);
    pinned!(BsInk, 8, 4, [
        element 0, red 4, green 5, blue 6, reserved 7,
    ]);
    pinned!(BsLine, 56, 8, [
        from 0, to 24, ink 48,
    ]);
    pinned!(BsPoint, 32, 8, [
        at 0, ink 24,
    ]);
    pinned!(BsDrawnShape, 128, 8, [
        shape 0, body 8, kind 16, reserved 20, geometry 24, pose 80, ink 120,
    ]);
    pinned!(BsDrawCalls, 40, 8, [
        size 0, reserved 4, user 8, line 16, point 24, shape 32,
    ]);
    pinned!(BsRay, 40, 8, [
        from 0, path 24, reserved 36,
    ]);
    pinned!(BsHit, 72, 8, [
        body 0, shape 8, point 16, normal 40, fraction 52, depth 56, triangle 60, hit 64, inside 65,
        reserved 66,
    ]);
    pinned!(BsOverlap, 16, 4, [
        body 0, shape 8,
    ]);
    pinned!(BsClosestPoint, 64, 8, [
        body 0, shape 8, point 16, normal 40, distance 52, triangle 56, found 60, inside 61,
        reserved 62,
    ]);
}

#[test]
fn contacts_and_surfaces_are_where_they_were() {
    pinned!(BsAabb, 48, 8, [
        min 0, max 24,
    ]);
    pinned!(BsSurface, 32, 4, [
        rolling_friction 0, spinning_friction 4, surface_velocity 8, contact_hertz 20, contact_damping 24,
        reserved 28,
    ]);
    pinned!(BsContactPoint, 32, 8, [
        position 0, separation 24, impulse 28,
    ]);
    pinned!(BsContact, 176, 8, [
        shapes 0, bodies 16, normal 32, point_count 44, points 48,
    ]);
    pinned!(BsBodyMove, 112, 8, [
        body 0, user_data 8, pose 16, centre_of_mass 56, linear_velocity 80, angular_velocity 92,
        fell_asleep 104, reserved 105,
    ]);
}

#[test]
fn couplings_and_strains_are_where_they_were() {
    pinned!(BsCoupling, 8, 4, [
        slot 0, generation 4,
    ]);
    pinned!(BsCoupledMotion, 24, 8, [
        joint 0, motion 8, axes 12, factor 16,
    ]);
    pinned!(BsCouplingDesc, 88, 8, [
        size 0, has_range 4, reserved 5, motions 8, min 56, max 64, break_force 72, user_data 80,
    ]);
    pinned!(BsStrainedJoint, 32, 4, [
        joint 0, force 8, torque 20,
    ]);
}

#[test]
fn casts_and_replays_are_where_they_were() {
    pinned!(BsWorldCharacter, 8, 4, [
        slot 0, generation 4,
    ]);
    pinned!(BsShapeCast, 88, 8, [
        size 0, path 4, pose 16, spin 56, pivot 68, shape 80,
    ]);
    pinned!(BsReplayOptions, 64, 8, [
        size 0, threads 4, substeps 8, iterations 12, bytes 16, vertices 24, triangles 32,
        bodies 40, joints 48, memory 56,
    ]);
    pinned!(BsDivergence, 56, 8, [
        size 0, stage 4, step 8, body 16, user_data 24, bodies 32, recorded_hash 40,
        replayed_hash 48,
    ]);
}
