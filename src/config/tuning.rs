//! Tunables: numbers that are chosen once for all worlds and that a physicist would want to try, each with
//! its unit, its range where one was measured, and the effects that it balances.
//!
//! Lengths are in [`Settings::length_unit`](super::Settings::length_unit)s where it says so. A number may
//! stay beside its kernel only if it is no choice: a bound on rounding, a sentinel, a limit of convergence,
//! an identity of geometry. Such a number has a line `// Rounding:`, `// Sentinel:` or `// Guard:` above it
//! that says which (`tests/house/main.rs` checks that).

/// Below this many bodies that can move, handing work to threads costs more than it saves (benches/steps.rs).
pub(crate) const MIN_THREADED_BODIES: usize = if cfg!(miri) { 2 } else { 128 };

/// A separation up to this counts as touching [length units]. It covers the gaps that springs of contacts at
/// rest leave: less, and resting bodies would count as apart; more, and hovering bodies would rub, carry
/// loads and cause events.
pub(crate) const TOUCH_DISTANCE: f32 = 0.002;

/// Contact points nearer than this are always kept [length units]: more costs rows that never push, less has
/// slow bodies meet without a row.
pub(crate) const CONTACT_MARGIN: f32 = 0.01;

/// Relative motion in a step above which a pair that is apart is cast [length units]: a smaller motion is
/// within the margin at the start of the step, and a cast would cost more than the points that it spares.
pub(crate) const CAST_MOTION: f32 = 0.01;

/// How far a pair may move before its contact is looked for again [length units]: further saves narrow phases
/// and leaves normals and points that are older.
pub(crate) const RECYCLE_DISTANCE: f32 = 0.005;

/// The share of it where a round surface touches at one or two points: a resting body keeps its contact, a
/// rolling body does not.
pub(crate) const ROUND_RECYCLE: f32 = 0.01;

/// Slip speed below which friction is static [m/s per length unit]: above the residual speed of resting
/// bodies, below visible sliding.
pub(crate) const STATIC_SLIP_SPEED: f32 = 0.01;

/// Time in which a load of a joint becomes one that it bears rigidly [s]: shorter, and the load of a passing
/// impact counts; longer, and a chain that is hung up stretches for longer.
pub(crate) const JOINT_HOLD_TIME: f32 = 1.0;

/// Friction of an impact that changes the slip by more than this shifts the load that a contact is taken to
/// bear [m/s per length unit]: less, and a resting body that rattles loses its load; more, and a body that an
/// impact pushed aside keeps a load that it no longer bears.
pub(crate) const LOAD_SHIFT_SPEED: f32 = 0.25;

// Broad phase

/// Widest margin of a fat box [length units]. Wider: more pairs are tested in vain. Narrower: boxes are
/// made anew more often. Range 0.02 to 0.5 (benches/steps.rs).
pub(crate) const FAT_MARGIN: f32 = 0.1;

/// Share of a body's longest side by which its fat box is wider than needed, at most by [`FAT_MARGIN`].
pub(crate) const FAT_SHARE: f32 = 0.1;

/// Share of [`FAT_MARGIN`] by which every fat box is wider at least: small bodies move too.
pub(crate) const LEAST_FAT_SHARE: f32 = 0.1;

/// Steps of motion that a fat box reaches ahead, at most by [`FAT_MARGIN`]: a falling body needs a new box
/// every few steps instead of every one or two. Range 1 to 8.
pub(crate) const FAT_STEPS_AHEAD: f32 = 4.0;

/// Growth of a tree's area at which it is built anew. A tree of resting bodies never gets there, one of
/// bodies that fly apart only after each growth by half. Range 1.2 to 3.
pub(crate) const TREE_AREA_GROWTH: f32 = 1.5;

/// Length of a path, in sizes of its box, from which the tree is searched along the path instead of in the
/// box around it. The box costs a third and finds few boxes that the path misses (scene `bullets`: from 8 on
/// no difference).
pub(crate) const LONG_PATH: f32 = 8.0;

// Narrow phase

/// Gap that a push should have closed, in margins, from which it counts as a ghost. Only counts depend on it.
pub(crate) const GHOST_GAP: f32 = 0.5;

/// How many times as far along the normal as past each other two bodies with a whole face between them may
/// move before their contact is looked for again.
pub(crate) const FACE_SINK: f32 = 4.0;

/// Sine of the fold under which an edge of a mesh counts as flat: 5 degrees. More: bodies cut visibly into
/// the ridges of a coarse sphere (at 5 degrees a ball of 1 m misses the ridge by 1 mm, twice the slop). Less:
/// the tessellation of smooth ground and the noise of its heights are felt.
pub(crate) const FLAT_EDGE_SINE: f32 = 0.087_155_74;

/// Cosine of the same angle.
pub(crate) const FLAT_EDGE_COSINE: f32 = 0.996_194_7;

/// Sine of the angle by which a way out of an overlap with a triangle may lead through it: the angle of a
/// flat edge. Less: a body that leans a little as it slides over the edge of a wall finds no way but along
/// the wall.
pub(crate) const THROUGH_SINE: f32 = FLAT_EDGE_SINE;

/// Cosine of the angle under which the normals of two patches of a mesh are one: 2.5 degrees, half the angle
/// of a flat edge.
pub(crate) const SAME_NORMAL_COSINE: f32 = 0.999;

/// Cosine of the angle above which two normals of a mesh are never merged, even where there are too many:
/// 25 degrees.
pub(crate) const RELATED_NORMAL_COSINE: f32 = 0.9;

/// Cosine of twice the angle of a flat edge: a normal nearer than this to a face may lie in the gap between
/// that face and its neighbour, where the shape may reach far below the face elsewhere.
pub(crate) const EDGE_GAP_COSINE: f32 = 0.984_807_8;

/// Cosine of the angle under which triangles may share a manifold: 3.6 degrees.
pub(crate) const ONE_MANIFOLD_COSINE: f32 = 0.998;

/// Sine of the same angle, rounded up.
pub(crate) const ONE_MANIFOLD_SINE: f32 = 0.064;

/// Cosine of the angle under which two planes of a mesh count as one for a body that rests on it: 0.25
/// degrees.
pub(crate) const SAME_PLANE_COSINE: f32 = 0.999_99;

/// Rotation within a step up to which the planes of one pose hold [rad].
pub(crate) const PLANE_TURN: f32 = 0.7;

/// Gap up to which two shapes touch at once when a predicted path is judged, as a share of
/// [`TOUCH_DISTANCE`].
pub(crate) const NO_GAP: f32 = 0.25;

/// Share of a cast's tolerance up to which rotation is ignored by it.
pub(crate) const UNSEEN_ROTATION: f32 = 0.1;

/// Sagitta of a curved path, as a share of the shape's radius, above which it is cut in two before triangles
/// are tested along it.
pub(crate) const SAGITTA_SHARE: f32 = 0.04;

/// Cosine of the angle under which two separating axes count as one: 1.8 degrees.
pub(crate) const SAME_AXIS_COSINE: f32 = 0.9995;

/// Share of the least half extent by which face axes, and those of `a`, are preferred. Large against rounding
/// and the tilt of a resting box, small against the slop.
pub(crate) const AXIS_BIAS: f32 = 1e-3;

/// Share of the depth by which face axes, and those of `a`, are preferred.
pub(crate) const AXIS_DEPTH_BIAS: f32 = 1e-2;

/// Cosine of the angle up to which faces of equal depth are better than edges: 14 degrees. In a heap of thin
/// planks on each other they lean by some.
pub(crate) const FLAT_FACE_COSINE: f32 = 0.97;

/// Share of the least half extent by which a face's lowest vertex may reach beyond the edge where clipping
/// drops it, of boxes that are apart.
pub(crate) const FLAT_FACE_BIAS: f32 = 5e-2;

/// Share of the least half extent by which side planes lie further out. Flush boxes (walls, pyramids) then
/// keep their vertices as features, whichever way rounding pushes them.
pub(crate) const FLUSH_BIAS: f32 = 1e-4;

/// Slope added to depths, so that equal depths are told apart: of a flat contact the same corners come first
/// in every step.
pub(crate) const TIE_SLOPE: f32 = 5e-5;

/// Faces are preferred to edges, and a's to b's, by this share of the overlap and of the size: a manifold of
/// four points that lasts is worth more than half a millimetre on a metre.
pub(crate) const FACE_PREFERENCE: (f32, f32) = (0.95, 5e-4);

/// Points of a manifold nearer than this share of its extent count as one.
pub(crate) const POINT_CLUSTER: f32 = 0.02;

/// A point that is deeper by less than this share of the manifold's extent counts as equally deep.
pub(crate) const POINT_DEEPER: f32 = 1e-4;

/// Squared sine under which two cores, or a core and an edge, lie along each other: 3 degrees.
pub(crate) const ALONG_SINE_SQUARED: f32 = 0.0025;

/// Share of the smaller size by which an axis of a cylinder may be worse than the best one and count as
/// equal: half a millimetre on a metre for a manifold that lasts. Also the tolerance of being inside a cap.
pub(crate) const CYLINDER_AXIS_TOLERANCE: f32 = 5e-4;

/// Two lines touch in two points while their ends lie beside each other by no more than this share of the
/// size: there a round side falls away by its square.
pub(crate) const LINE_TOUCH_ASIDE: f32 = 0.03;

/// Gap that is opened between overlapping cylinders before their distance is measured, as a share of the
/// size.
pub(crate) const CYLINDER_GAP: f32 = 2e-4;

/// Overlap from which on the way out may be far from the faces and axes that are tried, as a share of the
/// size.
pub(crate) const CYLINDER_DEEP: f32 = 2e-3;

/// Overlap up to which that way out is searched, as a share of the size.
pub(crate) const CYLINDER_TOO_DEEP: f32 = 0.2;

// Contacts that last

/// Rotation of both bodies together up to which a kept contact keeps its frame [rad]: bodies on a turntable
/// have their normals right within that. Range 0.0005 to 0.01.
pub(crate) const KEPT_CONTACT_TURN: f32 = 0.002;

/// Share by which a load may differ from the load by statics. Narrower: a lasting force is cut in every sway,
/// and pumps it. Wider: it lifts contacts that bear less.
pub(crate) const LOAD_BAND: f32 = 0.2;

/// Time in which lasting forces follow loads [s]: longer than a stack sways to and fro. Range 0.5 to 5.
pub(crate) const LOAD_TIME: f32 = 2.0;

/// How far springs act over a gap [slops]: an edge of a box that leans in a tall stack still bears something
/// 1 mm above its support, and a spring that ended there would drop it.
pub(crate) const SPRING_GAP: f32 = 10.0;

/// Weight of a load against the motion that it prevents, where the byte budget sheds contacts: a bearing
/// contact stays until another would cost clearly more, so that the choice does not change from step to step.
pub(crate) const LASTING_LOAD_WEIGHT: f32 = 2.0;

/// Share of an overlap that counts where contacts are shed. In full, deep pairs would take the place of
/// bearing ones, whose bodies would be the next to sink; with a tenth they stay deep for too long.
pub(crate) const OVERLAP_WEIGHT: f32 = 0.25;

/// Cost above which a contact is shed after all cheaper ones [length units]; of either, contacts with static
/// geometry go last.
pub(crate) const STATIC_WEIGHT: f32 = 0.02;

// Contact rows

/// Share of the mobility along the surface that is added to it where axes are locked: more than rounding, and
/// too little to cost friction more iterations.
pub(crate) const LOCKED_YIELD: f32 = 1e-4;

/// Largest share of the thinner shape's half width that the slop may take: the slop of a world made for boxes
/// of a metre would swallow a coin, and half of a wall of 1 mm.
pub(crate) const THIN_SLOP: f32 = 0.05;

/// Share by which the substep that springs are made for follows a longer step, so that it settles where one
/// step in eleven is longer: a hitch now and then softens nothing.
pub(crate) const SPRING_STEP_RISE: f32 = 0.01;

/// The same for a shorter step.
pub(crate) const SPRING_STEP_FALL: f32 = 0.001;

/// Share of a step's force in the mean force where every step has another length.
pub(crate) const NEW_FORCE_SHARE: f32 = 0.25;

/// Share of a step in the measure of how even steps are.
pub(crate) const EVENNESS_SHARE: f32 = 0.1;

/// Share by which a step may differ from the one before and count as equally long: frames are never quite
/// equal.
pub(crate) const EVEN_STEP_BAND: f32 = 0.1;

/// Speed of a body that overlap alone pushes, in push speeds: a pile that was made within itself parts within
/// a second.
pub(crate) const CROWD_PUSH: f32 = 4.0;

/// Overlap from which on it counts for that bound [slops]: resting and just hit bodies have less.
pub(crate) const CROWD_OVERLAP: f32 = 20.0;

/// Share of the stiffest spring that contacts have: with all of it a box on one a thousand times lighter
/// rocks ever more.
pub(crate) const STIFFEST_SPRING_SHARE: f32 = 0.83;

/// Most phase by which the spring of a soft contact turns in a substep [rad]: with more, the passes of a
/// substep no longer resolve how springs act on each other.
pub(crate) const SOFT_TURN: f32 = 1.0;

/// Least damping ratio of a soft contact: more than rounding gives back in a bounce, and far less than shows.
pub(crate) const LEAST_SOFT_DAMPING: f32 = 2e-6;

/// Depth of a soft contact from which on it is rigid, as a share of the inner radius of the thinner shape: a
/// centre stays outside with a margin, and the shapes keep the sides that face each other.
pub(crate) const SOFT_DEPTH: f32 = 0.5;

/// Cosine of the steepest slope that bears a load by statics: friction seldom holds more.
pub(crate) const STEEPEST_SUPPORT: f32 = 0.5;

/// Bodies that approach or part faster than after a fall of this many steps are not at rest for statics.
pub(crate) const REST_STEPS_OF_FALL: f32 = 2.0;

// Restitution

/// Share of [`BOUNCE_TOGETHER`] within which a point that ends a substep above a surface counts as touching
/// it.
pub(crate) const BOUNCE_REST_SHARE: f32 = 0.02;

/// Share of the restitution threshold below which an impact on a standing body is left to the rows.
pub(crate) const CREEP_SHARE: f32 = 0.05;

/// Gap up to which points bounce together with another one [length units].
pub(crate) const BOUNCE_TOGETHER: f32 = 0.0005;

// Joints

/// Share of a lasting load that a joint bears rigidly.
pub(crate) const JOINT_LOAD_SHARE: f32 = 0.9;

/// Error of a locked rotation above which it is no longer locked [rad].
pub(crate) const LOCK_AWRY: f32 = 0.05;

/// Rotation of a row's direction in a substep up to which its bend is known [rad].
pub(crate) const FOLLOWED_TURN: f32 = 0.1;

/// Energy of velocities along the chord of a circle, against those at its ends, that rows may have.
pub(crate) const CHORD_ENERGY: f64 = 2.0;

/// Energy, in allowed energies, above which a net of joints keeps nothing of the impulses of its rows.
pub(crate) const WILD_ENERGY: f64 = 100.0;

/// Share of the speeds at a lock that may be left between its bodies.
pub(crate) const LOCK_SPEED_LEFT: f32 = 0.01;

/// Rotation of bodies in energy-keeping trees up to which they are followed in parts [rad].
pub(crate) const FOLLOWED_IN_PARTS: f32 = 4.0;

/// Joints do no work: velocities with more than this factor times the energy without them are wrong. The
/// bound must not be tighter: RATTLE's energy oscillates by as much where bodies turn by a fifth of a radian
/// in a substep, and a one-sided bound would drain it (a box that spins at 50 rad/s lost 25 % in a minute;
/// see [`TreeBatch::tolerated`]).
pub(crate) const TREE_ENERGY_BAND: f32 = 1.02;

/// Opening of a joint by velocities, as a share of its arms, above which the substep was not followed: bodies
/// turned by half a radian or more.
pub(crate) const TREE_STRAIN: f32 = 0.02;

/// Share of the closing tolerance that is closed: the velocities need not know of it.
pub(crate) const TREE_CLOSED: f32 = 0.02;

/// Rotation in a substep above which a tree is followed in parts [rad]: beyond, Newton's method does not
/// converge.
pub(crate) const RATTLE_TURN: f32 = 0.25;

/// Largest number of such parts.
pub(crate) const RATTLE_PARTS: f32 = 16.0;

/// Trees are treated this way up to this square of frequency times substep, for a body that swings under the
/// load on its joint: at four RATTLE is unstable, and a body may have two such joints. At 0.5, one of 480
/// random trees lost 5 % of its energy, on the other path; at two, a chain that bears 100 times the mass of a
/// link came apart (60 Hz, 4 substeps).
pub(crate) const RATTLE_TAUT: f32 = 1.0;

/// Maximum load on a joint, as a multiple of the mass of a body there. With 100, two folded links whipped
/// faster than any substep follows, at 60 Hz with 4 and with 8 substeps; with 50 none did in 30 s.
pub(crate) const RATTLE_HEAVY: f32 = 50.0;

/// Above this multiple the result of a substep is checked: with loads of ten and twenty times their mass, two
/// links gained up to a sixth of their energy in the substep in which they folded. Two of equal mass gain
/// nothing that they do not lose again.
pub(crate) const RATTLE_LADEN: f32 = 5.0;

/// Pull of the bodies that hang on a joint, in their weights: a pendulum that falls from level pulls with
/// three.
pub(crate) const RATTLE_SWING: f32 = 3.0;

/// Minimum mass of a body, as a share of the mass that hangs on it. In `f32` mobilities keep a ten-millionth:
/// in chains of twenty, links of a 50,000th already lose some digits that matter, and links of a millionth
/// all.
pub(crate) const LIGHTEST_LINK: f32 = 5e-5;

/// Minimum moment of inertia of a body, as a share of the inertia that hinges and welds turn with it. The
/// mobility that a hinge leaves is a difference of differences, and loses more than that of a ball joint: an
/// arm with a 20,000th about its length gained energy in two of three substeps, one with a 10,000th in 10 of
/// 1,200, one with a thousandth in none.
pub(crate) const THINNEST_LINK: f32 = 1e-3;

/// Share of an error that is corrected within a substep. Contacts see a tree body by body and converge slowly
/// to a common solution; if errors are corrected faster, their disagreement grows (see
/// [`Softness::stiffest`](crate::constraint::contact::row::Softness::stiffest), with a load that does not
/// yield).
pub(crate) const TREE_RECOVERY: f32 = 0.2;

/// The same share for trees that touch something.
pub(crate) const TREE_RECOVERY_TOUCHING: f32 = 0.05;

/// Square of frequency times substep, of a body that turns on its joints, up to which it is integrated as it
/// is.
pub(crate) const TREE_SAFE_FREQUENCY: f32 = 0.5;

/// Distance that a body goes in a substep above which rows of distances and sliders may turn too far [length
/// units].
pub(crate) const SWIFT_DISTANCE: f32 = 0.02;

/// Greatest speed at which an error of a joint is taken back [length units/s] or [rad/s].
pub(crate) const JOINT_PUSH_SPEED: f32 = 40.0;

/// Stiffness of locks [Hz]. Range 60 to 480.
pub(crate) const JOINT_HERTZ: f32 = 240.0;

/// Damping ratio of locks.
pub(crate) const JOINT_DAMPING: f32 = 2.0;

/// Opening above which the joints of a tree are closed after bodies moved [length units] or [rad].
pub(crate) const JOINT_OPEN: f32 = 0.0005;

// Finish

/// Distance from its predicted end above which a body is settled [length units] (docs/decisions/settle.md).
pub(crate) const STRAY_DISTANCE: f32 = 0.0025;

/// Rotation in a step above which a touching body turns as a free one does [rad].
pub(crate) const FREE_SPIN_IN_TOUCH: f32 = 0.5;

/// Rotation above which a body's free rotation is computed in parts [rad]: out of the motion of a symmetric
/// top, by the difference of its two like moments, and about that top's axis. Energy and momentum are kept in
/// any case; this resolves the direction of the axis. Over a second a box of 1 m by 0.6 m by 0.3 m at 100
/// rad/s gets out of step by 0.01 rad.
pub(crate) const FREE_TURN_PART: f32 = 0.03;
pub(crate) const FREE_TURN_OWN: f32 = 0.6;

/// Largest number of such parts.
pub(crate) const FREE_TURN_PARTS: f32 = 16.0;

/// Distance of a centre that the guard holds from the surface, as a share of the inner ball.
pub(crate) const GUARD_DISTANCE: f32 = 0.25;

/// Share of that distance that it keeps when it runs along a surface.
pub(crate) const GUARD_GRAZE: f32 = 0.25;

/// Stands in for the inner ball of a shape whose origin is outside of it, as a share of its size.
pub(crate) const GUARD_HOLLOW: f32 = 1e-3;

/// Way of a limb's end in a step, as a share of the inner ball, up to which it is slow.
pub(crate) const SLOW_END: f32 = 0.25;

/// Share of a way that may go into a surface for the body to be led along it.
pub(crate) const PASSING_STEEPNESS: f32 = 0.5;

/// Share of its way up to which a tree that went no further is stuck.
pub(crate) const STUCK_TREE: f32 = 0.25;

/// Share of its speed that a stuck tree keeps: undamped, it would gain speed in every step.
pub(crate) const STUCK_TREE_SPEED: f32 = 0.5;

/// Depth of a centre in another body, as a share of its inner ball, up to which it is moved aside alone.
pub(crate) const CENTRE_ASIDE: f32 = 0.1;

// Other methods, characters

/// Tolerance of a touch for times of impact, as a share of the one for manifolds.
pub(crate) const IMPACT_TOLERANCE: f32 = 0.1;

/// Share of a fall that the flattest slope leaves to count as one to slide down, and not as a stop: that of 7
/// degrees.
pub(crate) const SLIDING_SLOPE: f64 = 1.0 / 64.0;

// Queries

/// How far neighbours may be from each other, at the start and at the end together, as a share of their
/// length. Long rays from anywhere to anywhere (2.1 to 3.2) are slower in streams, by a tenth to a fifth:
/// they want another order of nodes each. Rays from one place all around (1.3) are not, a fan has 0.02, a
/// camera 0.1 (benches/queries.rs).
pub(crate) const STREAM_SPREAD: f32 = 1.5;

// Vehicles

/// How often the forces of wheels that are casts are brought in line with each other in a step. They start
/// from the forces of the step before, and a parked car on 10 wheels of any proportions stands still
/// (tests/games/at_random/cars.rs).
pub(crate) const WHEEL_SWEEPS: usize = 16;
