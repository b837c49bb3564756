//! Debug drawing: a world as lines, points and shapes, through functions of the caller or into arrays.

use crate::abi::guard::call;
use crate::abi::pointers::Buffer;
use crate::abi::sized::{read, read_or_default};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::twin::{Twin, record};
use crate::abi::values::{BsBody, BsBool, BsDVec3, BsPose, BsShape};
use crate::body::BsBodyKind;
use crate::shape::BsGeometry;
use crate::world::{BsWorld, reading};
use backstop::debug::{DebugDraw, DrawOptions, DrawnShape, Element, Ink, Region};
use backstop::glam::DVec3;
use std::ffi::c_void;
use std::ptr::null_mut;

/// What is drawn, one of `BS_ELEMENT_...`.
pub type BsElement = u32;
/// A shape on a body.
pub const BS_ELEMENT_SHAPE: BsElement = 0;
/// The box around a shape.
pub const BS_ELEMENT_AABB: BsElement = 1;
/// The box that the broad phase keeps of it.
pub const BS_ELEMENT_FAT_AABB: BsElement = 2;
/// The path that a swept body would have taken in the last step.
pub const BS_ELEMENT_MOTION: BsElement = 3;
/// A point of contact that touched when the last step began.
pub const BS_ELEMENT_REAL_POINT: BsElement = 4;
/// One that was apart then.
pub const BS_ELEMENT_POTENTIAL_POINT: BsElement = 5;
/// A potential one that pushed although the shapes are apart after the step.
pub const BS_ELEMENT_GHOST_POINT: BsElement = 6;
/// From one surface to the other at a point of contact.
pub const BS_ELEMENT_GAP: BsElement = 7;
/// Normal at a point of contact, from the first shape to the second.
pub const BS_ELEMENT_NORMAL: BsElement = 8;
/// Impulse at a point of contact.
pub const BS_ELEMENT_IMPULSE: BsElement = 9;
/// An axis of a joint's frame.
pub const BS_ELEMENT_JOINT_FRAME: BsElement = 10;
/// The range of a joint's limit.
pub const BS_ELEMENT_JOINT_LIMIT: BsElement = 11;
/// From one frame of a joint to the other.
pub const BS_ELEMENT_JOINT_GAP: BsElement = 12;
/// A body's centre of mass.
pub const BS_ELEMENT_CENTRE_OF_MASS: BsElement = 13;
/// One of its principal axes of inertia.
pub const BS_ELEMENT_PRINCIPAL_AXIS: BsElement = 14;
/// A contact, in the solver's colour.
pub const BS_ELEMENT_SOLVER_COLOUR: BsElement = 15;
/// Something that this header has no name for.
pub const BS_ELEMENT_OTHER: BsElement = 255;

fn of_element(element: Element) -> BsElement {
    match element {
        Element::Shape => BS_ELEMENT_SHAPE,
        Element::Aabb => BS_ELEMENT_AABB,
        Element::FatAabb => BS_ELEMENT_FAT_AABB,
        Element::Motion => BS_ELEMENT_MOTION,
        Element::RealPoint => BS_ELEMENT_REAL_POINT,
        Element::PotentialPoint => BS_ELEMENT_POTENTIAL_POINT,
        Element::GhostPoint => BS_ELEMENT_GHOST_POINT,
        Element::Gap => BS_ELEMENT_GAP,
        Element::Normal => BS_ELEMENT_NORMAL,
        Element::Impulse => BS_ELEMENT_IMPULSE,
        Element::JointFrame => BS_ELEMENT_JOINT_FRAME,
        Element::JointLimit => BS_ELEMENT_JOINT_LIMIT,
        Element::JointGap => BS_ELEMENT_JOINT_GAP,
        Element::CentreOfMass => BS_ELEMENT_CENTRE_OF_MASS,
        Element::PrincipalAxis => BS_ELEMENT_PRINCIPAL_AXIS,
        Element::SolverColour => BS_ELEMENT_SOLVER_COLOUR,
        // Elements that the engine adds get numbers above.
        _ => BS_ELEMENT_OTHER,
    }
}

record! {
    /// What to draw.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsDrawOptions of options: DrawOptions {
        /// Size of this struct; `bs_draw_options_default` fills it in.
        pub size: u32 = size_of::<BsDrawOptions>() as u32,
        /// Shapes, in the colour of their body's kind. Default yes.
        pub shapes: BsBool,
        /// The box around each shape. Default no.
        pub aabbs: BsBool,
        /// The box that the broad phase keeps of each shape. Default no.
        pub fat_aabbs: BsBool,
        /// Swept paths of the last step. Default no.
        pub motion: BsBool,
        /// Points of contact. Default yes.
        pub contacts: BsBool,
        /// Normals and gaps at points of contact. Default no.
        pub normals: BsBool,
        /// Impulses at points of contact. Default no.
        pub impulses: BsBool,
        /// Frames, limits and gaps of joints. Default yes.
        pub joints: BsBool,
        /// Dynamic bodies in the colour of their island. Default no.
        pub islands: BsBool,
        /// Centres of mass and principal axes. Default no.
        pub centres: BsBool,
        /// Contacts in the colour that the solver gave them. Default no.
        pub solver_colours: BsBool,
        /// Whether only what is in the box from `region_min` to `region_max` is drawn. Default no.
        pub has_region: BsBool = options.region.is_some().into(),
        /// Low corner [m].
        pub region_min: BsDVec3 = options.region.map(|region| region.min.into()).unwrap_or_default(),
        /// High corner [m].
        pub region_max: BsDVec3 = options.region.map(|region| region.max.into()).unwrap_or_default(),
        /// Length of normals and of the axes of frames [m]. Default 0.2.
        pub length: f32,
        /// Length of an impulse of 1 N s [m]. Default 0.01.
        pub impulse_scale: f32,
    }
    default bs_draw_options_default()
}

/// Shapes, points of contact and joints.
#[unsafe(no_mangle)]
pub extern "C" fn bs_draw_options_default() -> BsDrawOptions {
    BsDrawOptions::of_engine(&DrawOptions::default())
}

impl BsDrawOptions {
    fn to_engine(self) -> Outcome<DrawOptions> {
        let region = Region { min: self.region_min.into(), max: self.region_max.into() };
        let mut options = self.on(DrawOptions::nothing())?;
        options.region = (self.has_region != 0).then_some(region);
        Ok(options)
    }
}

/// What is drawn, and in which colour (sRGB).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BsInk {
    /// What it is.
    pub element: BsElement,
    /// 0 to 255.
    pub red: u8,
    /// 0 to 255.
    pub green: u8,
    /// 0 to 255.
    pub blue: u8,
    /// Zero.
    pub reserved: u8,
}

fn of_ink(ink: Ink) -> BsInk {
    let colour = ink.colour;
    let element = of_element(ink.element);
    BsInk { element, red: colour.red, green: colour.green, blue: colour.blue, reserved: 0 }
}

/// A line of a drawing.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsLine {
    /// One end, in the world [m].
    pub from: BsDVec3,
    /// The other end.
    pub to: BsDVec3,
    /// What it is.
    pub ink: BsInk,
}

/// A point of a drawing.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsPoint {
    /// Where, in the world [m].
    pub at: BsDVec3,
    /// What it is.
    pub ink: BsInk,
}

/// A shape of a drawing, for renderers with meshes of their own (`bs_geometry_triangles`).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsDrawnShape {
    /// Which: the same from call to call.
    pub shape: BsShape,
    /// Its body.
    pub body: BsBody,
    /// Kind of its body.
    pub kind: BsBodyKind,
    /// Zero.
    pub reserved: u32,
    /// Its form, in its own frame. Its pointer is valid until the call returns.
    pub geometry: BsGeometry,
    /// Where its frame is in the world.
    pub pose: BsPose,
    /// What it is.
    pub ink: BsInk,
}

record! {
    /// Functions of the caller that draw. They may read the world, and must not change it, nor throw or jump
    /// out of the call. Each may be null.
    #[repr(C)]
    #[derive(Clone, Copy, Debug)]
    pub struct BsDrawCalls {
        /// Size of this struct; `bs_draw_calls_default` fills it in.
        pub size: u32,
        /// Zero.
        pub reserved: u32,
        /// What the functions are called with.
        pub user: *mut c_void,
        /// Draws a line.
        pub line: Option<unsafe extern "C" fn(user: *mut c_void, line: *const BsLine)>,
        /// Draws a point.
        pub point: Option<unsafe extern "C" fn(user: *mut c_void, point: *const BsPoint)>,
        /// Draws a shape; null: shapes come as lines.
        pub shape: Option<unsafe extern "C" fn(user: *mut c_void, shape: *const BsDrawnShape)>,
    }
    default bs_draw_calls_default()
}

/// Functions that draw nothing.
#[unsafe(no_mangle)]
pub extern "C" fn bs_draw_calls_default() -> BsDrawCalls {
    let size = size_of::<BsDrawCalls>() as u32;
    BsDrawCalls { size, reserved: 0, user: null_mut(), line: None, point: None, shape: None }
}

/// The caller's functions as the engine's renderer. Whoever makes one promises that they may be called.
struct Calls(BsDrawCalls);

fn line_of(from: DVec3, to: DVec3, ink: Ink) -> BsLine {
    BsLine { from: from.into(), to: to.into(), ink: of_ink(ink) }
}

fn point_of(at: DVec3, ink: Ink) -> BsPoint {
    BsPoint { at: at.into(), ink: of_ink(ink) }
}

impl DebugDraw for Calls {
    fn shape(&mut self, shape: &DrawnShape<'_>) {
        let Some(draw) = self.0.shape else {
            if self.0.line.is_some() {
                shape.wireframe(&mut |from, to| self.line(from, to, shape.ink));
            }
            return;
        };
        let drawn = BsDrawnShape {
            shape: shape.shape.into(),
            body: shape.body.into(),
            kind: Twin::write(&shape.kind),
            reserved: 0,
            geometry: BsGeometry::of_engine(shape.geometry),
            pose: BsPose { position: shape.position.into(), rotation: shape.rotation.into() },
            ink: of_ink(shape.ink),
        };
        // SAFETY: see the type.
        unsafe { draw(self.0.user, &drawn) }
    }

    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        if let Some(draw) = self.0.line {
            // SAFETY: see the type.
            unsafe { draw(self.0.user, &line_of(from, to, ink)) }
        }
    }

    fn point(&mut self, at: DVec3, ink: Ink) {
        if let Some(draw) = self.0.point {
            // SAFETY: see the type.
            unsafe { draw(self.0.user, &point_of(at, ink)) }
        }
    }
}

/// Draws what the options ask for, through the caller's functions. `options` may be null: the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_draw(
    world: *const BsWorld,
    options: *const BsDrawOptions,
    calls: *const BsDrawCalls,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, options, calls) = unsafe { (reading(world)?, read_or_default(options)?, read(calls)?) };
        content.draw(&options.to_engine()?, &mut Calls(calls));
        Ok(())
    })
}

#[derive(Default)]
struct Sketch {
    lines: Vec<BsLine>,
    points: Vec<BsPoint>,
}

impl DebugDraw for Sketch {
    fn line(&mut self, from: DVec3, to: DVec3, ink: Ink) {
        self.lines.push(line_of(from, to, ink));
    }

    fn point(&mut self, at: DVec3, ink: Ink) {
        self.points.push(point_of(at, ink));
    }
}

/// Draws what the options ask for as lines and points, into arrays. The counts become their numbers; if
/// either buffer is too short, nothing else is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_draw_arrays(
    world: *const BsWorld,
    options: *const BsDrawOptions,
    lines: *mut BsLine,
    line_capacity: usize,
    line_count: *mut usize,
    points: *mut BsPoint,
    point_capacity: usize,
    point_count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, options, lines, points) = unsafe {
            let lines = Buffer::new("lines", lines, line_capacity, line_count)?;
            let points = Buffer::new("points", points, point_capacity, point_count)?;
            (reading(world)?, read_or_default(options)?, lines, points)
        };
        let mut sketch = Sketch::default();
        content.draw(&options.to_engine()?, &mut sketch);
        // Both counts are written, whichever is too short.
        let (room, rest) = (lines.reserve(sketch.lines.len()), points.reserve(sketch.points.len()));
        room.and(rest)?;
        lines.fill(sketch.lines.into_iter())?;
        points.fill(sketch.points.into_iter())
    })
}
