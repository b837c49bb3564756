// The layout of every struct as the C compiler has it: the numbers of tests/layout.rs.
#include "backstop.h"

#define SIZE(type, size) _Static_assert(sizeof(type) == size, #type)
#define FIELD(type, field, at) _Static_assert(offsetof(type, field) == at, #type "." #field)

SIZE(BsVec3, 12);
FIELD(BsVec3, x, 0);
FIELD(BsVec3, y, 4);
FIELD(BsVec3, z, 8);

SIZE(BsDVec3, 24);
FIELD(BsDVec3, x, 0);
FIELD(BsDVec3, y, 8);
FIELD(BsDVec3, z, 16);

SIZE(BsQuat, 16);
FIELD(BsQuat, x, 0);
FIELD(BsQuat, y, 4);
FIELD(BsQuat, z, 8);
FIELD(BsQuat, w, 12);

SIZE(BsGeometry, 56);
FIELD(BsGeometry, kind, 0);
FIELD(BsGeometry, half_height, 4);
FIELD(BsGeometry, radius, 8);
FIELD(BsGeometry, radius_top, 12);
FIELD(BsGeometry, half_extents, 16);
FIELD(BsGeometry, reserved, 28);
FIELD(BsGeometry, hull, 32);
FIELD(BsGeometry, mesh, 40);
FIELD(BsGeometry, height_field, 48);

SIZE(BsMaterial, 24);
FIELD(BsMaterial, static_friction, 0);
FIELD(BsMaterial, dynamic_friction, 4);
FIELD(BsMaterial, restitution, 8);
FIELD(BsMaterial, friction_combine, 12);
FIELD(BsMaterial, restitution_combine, 16);
FIELD(BsMaterial, reserved, 20);

SIZE(BsFilter, 24);
FIELD(BsFilter, category, 0);
FIELD(BsFilter, mask, 8);
FIELD(BsFilter, group, 16);
FIELD(BsFilter, reserved, 20);

SIZE(BsShapeDesc, 184);
FIELD(BsShapeDesc, size, 0);
FIELD(BsShapeDesc, sensor, 4);
FIELD(BsShapeDesc, events, 5);
FIELD(BsShapeDesc, senses_static, 6);
FIELD(BsShapeDesc, reserved, 7);
FIELD(BsShapeDesc, geometry, 8);
FIELD(BsShapeDesc, position, 64);
FIELD(BsShapeDesc, rotation, 76);
FIELD(BsShapeDesc, density, 92);
FIELD(BsShapeDesc, material, 96);
FIELD(BsShapeDesc, filter, 120);
FIELD(BsShapeDesc, user_data, 144);
FIELD(BsShapeDesc, surface, 152);

SIZE(BsMassProperties, 52);
FIELD(BsMassProperties, mass, 0);
FIELD(BsMassProperties, centre_of_mass, 4);
FIELD(BsMassProperties, inertia, 16);

SIZE(BsBodyDesc, 136);
FIELD(BsBodyDesc, size, 0);
FIELD(BsBodyDesc, kind, 4);
FIELD(BsBodyDesc, position, 8);
FIELD(BsBodyDesc, rotation, 32);
FIELD(BsBodyDesc, linear_velocity, 48);
FIELD(BsBodyDesc, angular_velocity, 60);
FIELD(BsBodyDesc, shapes, 72);
FIELD(BsBodyDesc, shape_count, 80);
FIELD(BsBodyDesc, mass, 88);
FIELD(BsBodyDesc, gravity_scale, 96);
FIELD(BsBodyDesc, continuous, 100);
FIELD(BsBodyDesc, solved_after, 104);
FIELD(BsBodyDesc, lock_translation, 108);
FIELD(BsBodyDesc, lock_rotation, 109);
FIELD(BsBodyDesc, can_sleep, 110);
FIELD(BsBodyDesc, reserved, 111);
FIELD(BsBodyDesc, user_data, 112);
FIELD(BsBodyDesc, linear_damping, 120);
FIELD(BsBodyDesc, angular_damping, 124);
FIELD(BsBodyDesc, max_linear_speed, 128);
FIELD(BsBodyDesc, max_angular_speed, 132);

SIZE(BsBody, 8);
FIELD(BsBody, slot, 0);
FIELD(BsBody, generation, 4);

SIZE(BsPose, 40);
FIELD(BsPose, position, 0);
FIELD(BsPose, rotation, 24);

SIZE(BsColumns, 56);
FIELD(BsColumns, size, 0);
FIELD(BsColumns, position_type, 4);
FIELD(BsColumns, positions, 8);
FIELD(BsColumns, rotations, 16);
FIELD(BsColumns, linear_velocities, 24);
FIELD(BsColumns, angular_velocities, 32);
FIELD(BsColumns, position_stride, 40);
FIELD(BsColumns, rotation_stride, 44);
FIELD(BsColumns, linear_stride, 48);
FIELD(BsColumns, angular_stride, 52);

SIZE(BsCharacterSettings, 52);
FIELD(BsCharacterSettings, size, 0);
FIELD(BsCharacterSettings, radius, 4);
FIELD(BsCharacterSettings, half_height, 8);
FIELD(BsCharacterSettings, skin, 12);
FIELD(BsCharacterSettings, max_slope, 16);
FIELD(BsCharacterSettings, step_height, 20);
FIELD(BsCharacterSettings, snap, 24);
FIELD(BsCharacterSettings, iterations, 28);
FIELD(BsCharacterSettings, up, 32);
FIELD(BsCharacterSettings, mass, 44);
FIELD(BsCharacterSettings, strength, 48);

SIZE(BsShape, 8);
FIELD(BsShape, slot, 0);
FIELD(BsShape, generation, 4);

SIZE(BsQueryFilter, 88);
FIELD(BsQueryFilter, size, 0);
FIELD(BsQueryFilter, statics, 4);
FIELD(BsQueryFilter, kinematic, 5);
FIELD(BsQueryFilter, dynamic, 6);
FIELD(BsQueryFilter, sensors, 7);
FIELD(BsQueryFilter, skip_inside, 8);
FIELD(BsQueryFilter, has_filter, 9);
FIELD(BsQueryFilter, reserved, 10);
FIELD(BsQueryFilter, filter, 16);
FIELD(BsQueryFilter, exclude_body, 40);
FIELD(BsQueryFilter, exclude_shape, 48);
FIELD(BsQueryFilter, predicate, 56);
FIELD(BsQueryFilter, user, 64);
FIELD(BsQueryFilter, only_body, 72);
FIELD(BsQueryFilter, only_shape, 80);

SIZE(BsGround, 64);
FIELD(BsGround, body, 0);
FIELD(BsGround, shape, 8);
FIELD(BsGround, point, 16);
FIELD(BsGround, normal, 40);
FIELD(BsGround, velocity, 52);

SIZE(BsCharacterReport, 160);
FIELD(BsCharacterReport, size, 0);
FIELD(BsCharacterReport, stepped, 4);
FIELD(BsCharacterReport, position, 8);
FIELD(BsCharacterReport, moved, 32);
FIELD(BsCharacterReport, carried, 44);
FIELD(BsCharacterReport, pushed_out, 56);
FIELD(BsCharacterReport, velocity, 68);
FIELD(BsCharacterReport, turned, 80);
FIELD(BsCharacterReport, overlap, 84);
FIELD(BsCharacterReport, ground, 88);
FIELD(BsCharacterReport, on_ground, 152);
FIELD(BsCharacterReport, reserved, 153);

SIZE(BsCharacterHit, 64);
FIELD(BsCharacterHit, body, 0);
FIELD(BsCharacterHit, shape, 8);
FIELD(BsCharacterHit, point, 16);
FIELD(BsCharacterHit, normal, 40);
FIELD(BsCharacterHit, impulse, 52);

SIZE(BsDrawOptions, 72);
FIELD(BsDrawOptions, size, 0);
FIELD(BsDrawOptions, shapes, 4);
FIELD(BsDrawOptions, aabbs, 5);
FIELD(BsDrawOptions, fat_aabbs, 6);
FIELD(BsDrawOptions, motion, 7);
FIELD(BsDrawOptions, contacts, 8);
FIELD(BsDrawOptions, normals, 9);
FIELD(BsDrawOptions, impulses, 10);
FIELD(BsDrawOptions, joints, 11);
FIELD(BsDrawOptions, islands, 12);
FIELD(BsDrawOptions, centres, 13);
FIELD(BsDrawOptions, solver_colours, 14);
FIELD(BsDrawOptions, has_region, 15);
FIELD(BsDrawOptions, region_min, 16);
FIELD(BsDrawOptions, region_max, 40);
FIELD(BsDrawOptions, length, 64);
FIELD(BsDrawOptions, impulse_scale, 68);

SIZE(BsInk, 8);
FIELD(BsInk, element, 0);
FIELD(BsInk, red, 4);
FIELD(BsInk, green, 5);
FIELD(BsInk, blue, 6);
FIELD(BsInk, reserved, 7);

SIZE(BsLine, 56);
FIELD(BsLine, from, 0);
FIELD(BsLine, to, 24);
FIELD(BsLine, ink, 48);

SIZE(BsPoint, 32);
FIELD(BsPoint, at, 0);
FIELD(BsPoint, ink, 24);

SIZE(BsDrawnShape, 128);
FIELD(BsDrawnShape, shape, 0);
FIELD(BsDrawnShape, body, 8);
FIELD(BsDrawnShape, kind, 16);
FIELD(BsDrawnShape, reserved, 20);
FIELD(BsDrawnShape, geometry, 24);
FIELD(BsDrawnShape, pose, 80);
FIELD(BsDrawnShape, ink, 120);

SIZE(BsDrawCalls, 40);
FIELD(BsDrawCalls, size, 0);
FIELD(BsDrawCalls, reserved, 4);
FIELD(BsDrawCalls, user, 8);
FIELD(BsDrawCalls, line, 16);
FIELD(BsDrawCalls, point, 24);
FIELD(BsDrawCalls, shape, 32);

SIZE(BsContactEvent, 80);
FIELD(BsContactEvent, shapes, 0);
FIELD(BsContactEvent, bodies, 16);
FIELD(BsContactEvent, point, 32);
FIELD(BsContactEvent, normal, 56);
FIELD(BsContactEvent, approach_speed, 68);
FIELD(BsContactEvent, impulse, 72);
FIELD(BsContactEvent, reserved, 76);

SIZE(BsContactEnd, 16);
FIELD(BsContactEnd, shapes, 0);

SIZE(BsSensorEvent, 20);
FIELD(BsSensorEvent, sensor, 0);
FIELD(BsSensorEvent, visitor, 8);
FIELD(BsSensorEvent, fraction, 16);

SIZE(BsJoint, 8);
FIELD(BsJoint, slot, 0);
FIELD(BsJoint, generation, 4);

SIZE(BsSpring, 12);
FIELD(BsSpring, kind, 0);
FIELD(BsSpring, stiffness, 4);
FIELD(BsSpring, damping, 8);

SIZE(BsLimitDesc, 32);
FIELD(BsLimitDesc, size, 0);
FIELD(BsLimitDesc, motion, 4);
FIELD(BsLimitDesc, axes, 8);
FIELD(BsLimitDesc, min, 12);
FIELD(BsLimitDesc, max, 16);
FIELD(BsLimitDesc, spring, 20);

SIZE(BsDriveDesc, 36);
FIELD(BsDriveDesc, size, 0);
FIELD(BsDriveDesc, motion, 4);
FIELD(BsDriveDesc, axis, 8);
FIELD(BsDriveDesc, position, 12);
FIELD(BsDriveDesc, velocity, 16);
FIELD(BsDriveDesc, spring, 20);
FIELD(BsDriveDesc, max_force, 32);

SIZE(BsFrame, 28);
FIELD(BsFrame, position, 0);
FIELD(BsFrame, rotation, 12);

SIZE(BsJointDesc, 168);
FIELD(BsJointDesc, size, 0);
FIELD(BsJointDesc, kind, 4);
FIELD(BsJointDesc, bodies, 8);
FIELD(BsJointDesc, frames, 24);
FIELD(BsJointDesc, range_min, 80);
FIELD(BsJointDesc, range_max, 84);
FIELD(BsJointDesc, spring, 88);
FIELD(BsJointDesc, break_force, 100);
FIELD(BsJointDesc, break_torque, 104);
FIELD(BsJointDesc, solved_after, 108);
FIELD(BsJointDesc, collide, 112);
FIELD(BsJointDesc, reserved, 113);
FIELD(BsJointDesc, limits, 120);
FIELD(BsJointDesc, limit_count, 128);
FIELD(BsJointDesc, drives, 136);
FIELD(BsJointDesc, drive_count, 144);
FIELD(BsJointDesc, user_data, 152);
FIELD(BsJointDesc, force_threshold, 160);
FIELD(BsJointDesc, torque_threshold, 164);

SIZE(BsRay, 40);
FIELD(BsRay, from, 0);
FIELD(BsRay, path, 24);
FIELD(BsRay, reserved, 36);

SIZE(BsHit, 72);
FIELD(BsHit, body, 0);
FIELD(BsHit, shape, 8);
FIELD(BsHit, point, 16);
FIELD(BsHit, normal, 40);
FIELD(BsHit, fraction, 52);
FIELD(BsHit, depth, 56);
FIELD(BsHit, triangle, 60);
FIELD(BsHit, hit, 64);
FIELD(BsHit, inside, 65);
FIELD(BsHit, reserved, 66);

SIZE(BsOverlap, 16);
FIELD(BsOverlap, body, 0);
FIELD(BsOverlap, shape, 8);

SIZE(BsClosestPoint, 64);
FIELD(BsClosestPoint, body, 0);
FIELD(BsClosestPoint, shape, 8);
FIELD(BsClosestPoint, point, 16);
FIELD(BsClosestPoint, normal, 40);
FIELD(BsClosestPoint, distance, 52);
FIELD(BsClosestPoint, triangle, 56);
FIELD(BsClosestPoint, found, 60);
FIELD(BsClosestPoint, inside, 61);
FIELD(BsClosestPoint, reserved, 62);

SIZE(BsBoneDesc, 80);
FIELD(BsBoneDesc, size, 0);
FIELD(BsBoneDesc, parent, 4);
FIELD(BsBoneDesc, joint_at, 8);
FIELD(BsBoneDesc, from, 20);
FIELD(BsBoneDesc, to, 32);
FIELD(BsBoneDesc, radius, 44);
FIELD(BsBoneDesc, joint, 48);
FIELD(BsBoneDesc, swing, 52);
FIELD(BsBoneDesc, twist, 56);
FIELD(BsBoneDesc, axis, 60);
FIELD(BsBoneDesc, min, 72);
FIELD(BsBoneDesc, max, 76);

SIZE(BsSkeletonDesc, 112);
FIELD(BsSkeletonDesc, size, 0);
FIELD(BsSkeletonDesc, density, 4);
FIELD(BsSkeletonDesc, bones, 8);
FIELD(BsSkeletonDesc, bone_count, 16);
FIELD(BsSkeletonDesc, material, 24);
FIELD(BsSkeletonDesc, filter, 48);
FIELD(BsSkeletonDesc, friction, 72);
FIELD(BsSkeletonDesc, reserved, 76);
FIELD(BsSkeletonDesc, surface, 80);

SIZE(BsSettings, 264);
FIELD(BsSettings, size, 0);
FIELD(BsSettings, gravity, 4);
FIELD(BsSettings, substeps, 16);
FIELD(BsSettings, iterations, 20);
FIELD(BsSettings, threads, 24);
FIELD(BsSettings, continuous, 28);
FIELD(BsSettings, method, 32);
FIELD(BsSettings, friction_cone, 36);
FIELD(BsSettings, friction_model, 40);
FIELD(BsSettings, length_unit, 44);
FIELD(BsSettings, restitution_threshold, 48);
FIELD(BsSettings, slop, 52);
FIELD(BsSettings, contact_hertz, 56);
FIELD(BsSettings, contact_damping, 60);
FIELD(BsSettings, push_speed, 64);
FIELD(BsSettings, warm_starting, 68);
FIELD(BsSettings, recycling, 69);
FIELD(BsSettings, joint_trees, 70);
FIELD(BsSettings, guard, 71);
FIELD(BsSettings, sleeping, 72);
FIELD(BsSettings, reserved, 73);
FIELD(BsSettings, sleep_speed, 80);
FIELD(BsSettings, sleep_time, 84);
FIELD(BsSettings, hit_speed, 88);
FIELD(BsSettings, event_capacity, 92);
FIELD(BsSettings, order, 96);
FIELD(BsSettings, budget, 128);
FIELD(BsSettings, budget_of, 136);

SIZE(BsStepReport, 132);
FIELD(BsStepReport, size, 0);
FIELD(BsStepReport, step_us, 4);
FIELD(BsStepReport, broad_us, 8);
FIELD(BsStepReport, narrow_us, 12);
FIELD(BsStepReport, prepare_us, 16);
FIELD(BsStepReport, solve_us, 20);
FIELD(BsStepReport, finish_us, 24);
FIELD(BsStepReport, pairs, 28);
FIELD(BsStepReport, moved, 32);
FIELD(BsStepReport, swept, 36);
FIELD(BsStepReport, manifolds, 40);
FIELD(BsStepReport, real, 44);
FIELD(BsStepReport, potential, 48);
FIELD(BsStepReport, pushed, 52);
FIELD(BsStepReport, ghosts, 56);
FIELD(BsStepReport, recycled, 60);
FIELD(BsStepReport, casts, 64);
FIELD(BsStepReport, impacts, 68);
FIELD(BsStepReport, batches, 72);
FIELD(BsStepReport, uncoloured, 76);
FIELD(BsStepReport, cut, 80);
FIELD(BsStepReport, lifted, 84);
FIELD(BsStepReport, settled, 88);
FIELD(BsStepReport, weighted_trees, 92);
FIELD(BsStepReport, damped_trees, 96);
FIELD(BsStepReport, stopped, 100);
FIELD(BsStepReport, struck, 104);
FIELD(BsStepReport, stood, 108);
FIELD(BsStepReport, asleep, 112);
FIELD(BsStepReport, slept, 116);
FIELD(BsStepReport, woke, 120);
FIELD(BsStepReport, events_lost, 124);
FIELD(BsStepReport, shed, 128);

SIZE(BsBytes, 24);
FIELD(BsBytes, live, 0);
FIELD(BsBytes, reserved, 8);
FIELD(BsBytes, peak, 16);

SIZE(BsMemoryReport, 400);
FIELD(BsMemoryReport, size, 0);
FIELD(BsMemoryReport, categories, 4);
FIELD(BsMemoryReport, total, 8);
FIELD(BsMemoryReport, of, 16);

SIZE(BsModelPart, 24);
FIELD(BsModelPart, feature, 0);
FIELD(BsModelPart, count, 4);
FIELD(BsModelPart, bytes, 8);
FIELD(BsModelPart, time_us, 16);
FIELD(BsModelPart, has_time, 20);
FIELD(BsModelPart, reserved, 21);

SIZE(BsAabb, 48);
FIELD(BsAabb, min, 0);
FIELD(BsAabb, max, 24);

SIZE(BsSurface, 32);
FIELD(BsSurface, rolling_friction, 0);
FIELD(BsSurface, spinning_friction, 4);
FIELD(BsSurface, surface_velocity, 8);
FIELD(BsSurface, contact_hertz, 20);
FIELD(BsSurface, contact_damping, 24);
FIELD(BsSurface, reserved, 28);

SIZE(BsContactPoint, 32);
FIELD(BsContactPoint, position, 0);
FIELD(BsContactPoint, separation, 24);
FIELD(BsContactPoint, impulse, 28);

SIZE(BsContact, 176);
FIELD(BsContact, shapes, 0);
FIELD(BsContact, bodies, 16);
FIELD(BsContact, normal, 32);
FIELD(BsContact, point_count, 44);
FIELD(BsContact, points, 48);

SIZE(BsCoupling, 8);
FIELD(BsCoupling, slot, 0);
FIELD(BsCoupling, generation, 4);
SIZE(BsCoupledMotion, 24);
FIELD(BsCoupledMotion, joint, 0);
FIELD(BsCoupledMotion, motion, 8);
FIELD(BsCoupledMotion, axes, 12);
FIELD(BsCoupledMotion, factor, 16);
SIZE(BsCouplingDesc, 88);
FIELD(BsCouplingDesc, size, 0);
FIELD(BsCouplingDesc, has_range, 4);
FIELD(BsCouplingDesc, reserved, 5);
FIELD(BsCouplingDesc, motions, 8);
FIELD(BsCouplingDesc, min, 56);
FIELD(BsCouplingDesc, max, 64);
FIELD(BsCouplingDesc, strength, 72);
FIELD(BsCouplingDesc, user_data, 80);
SIZE(BsStrainedJoint, 32);
FIELD(BsStrainedJoint, joint, 0);
FIELD(BsStrainedJoint, force, 8);
FIELD(BsStrainedJoint, torque, 20);

SIZE(BsWorldCharacter, 8);
FIELD(BsWorldCharacter, slot, 0);
FIELD(BsWorldCharacter, generation, 4);

SIZE(BsShapeCast, 88);
FIELD(BsShapeCast, size, 0);
FIELD(BsShapeCast, path, 4);
FIELD(BsShapeCast, pose, 16);
FIELD(BsShapeCast, spin, 56);
FIELD(BsShapeCast, pivot, 68);
FIELD(BsShapeCast, shape, 80);

SIZE(BsReplayOptions, 64);
FIELD(BsReplayOptions, size, 0);
FIELD(BsReplayOptions, threads, 4);
FIELD(BsReplayOptions, substeps, 8);
FIELD(BsReplayOptions, iterations, 12);
FIELD(BsReplayOptions, bytes, 16);
FIELD(BsReplayOptions, vertices, 24);
FIELD(BsReplayOptions, triangles, 32);
FIELD(BsReplayOptions, bodies, 40);
FIELD(BsReplayOptions, joints, 48);
FIELD(BsReplayOptions, memory, 56);

SIZE(BsDivergence, 56);
FIELD(BsDivergence, size, 0);
FIELD(BsDivergence, stage, 4);
FIELD(BsDivergence, step, 8);
FIELD(BsDivergence, body, 16);
FIELD(BsDivergence, user_data, 24);
FIELD(BsDivergence, bodies, 32);
FIELD(BsDivergence, recorded_hash, 40);
FIELD(BsDivergence, replayed_hash, 48);
