//! Which elements are drawn, where, and in which colours.

use glam::DVec3;

/// Options of [`World::draw`](crate::World::draw). By default shapes, contacts and joints.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawOptions {
    /// Shapes, in the colour of their body's kind. Default yes.
    pub shapes: bool,
    /// The box around each shape where it is now. Default no.
    pub aabbs: bool,
    /// The box that the broad phase keeps of each shape: with a margin, of a swept shape around its whole
    /// path. As the last step left it. Default no.
    pub fat_aabbs: bool,
    /// For each shape that was fast in the last step, its swept path: from its start to where it would be if
    /// nothing had been in its way. Default no.
    pub motion: bool,
    /// Points of contact. Default yes.
    ///
    /// *Real*: within 2 mm of touching when the last step began. *Potential*: further apart then, but near
    /// enough, or fast enough, that they might have touched within it. *Ghost*: a potential point of a
    /// contact that had to push, though the two shapes are more than 5 mm apart after the step. As far as is
    /// known then, it removed velocity for a touch that did not occur; shapes that touched in passing and
    /// separated within the step count too. The next [`StepReport::ghosts`](crate::StepReport::ghosts) counts
    /// these. Both lengths times [`Settings::length_unit`](crate::Settings::length_unit).
    ///
    /// A point lies midway between the two surfaces, where the bodies are now.
    pub contacts: bool,
    /// At each point of contact the normal, [`Self::length`] long, and the gap or overlap of the surfaces.
    /// Default no.
    pub normals: bool,
    /// At each point of contact the normal impulse of the last substep, along the normal. Default no.
    pub impulses: bool,
    /// Joints: the axes of both frames, red, green and blue for x, y and z; the range of each limit; the gap
    /// between the frames' origins. Default yes.
    pub joints: bool,
    /// Shapes of dynamic bodies in the colour of their island instead: all that touch or are joined have one.
    /// Default no.
    pub islands: bool,
    /// Centres of mass, with the principal axes of inertia of dynamic bodies. Default no.
    pub centres: bool,
    /// For each contact that got rows in the last step, a line from body to body (from a body to the point,
    /// if the other can't move) in the colour that the solver gave it. No two lines of a colour end at the
    /// same dynamic body; white ones found no colour and are solved one by one. Default no.
    pub solver_colours: bool,
    /// Only elements in this box; for a mesh or height field, only the triangles that may be in it. Default
    /// none: all.
    pub region: Option<Region>,
    /// Length of normals and of the axes of frames [m]. Default 0.2.
    pub length: f32,
    /// Length of an impulse of 1 N s [m]. Default 0.01.
    pub impulse_scale: f32,
    /// Colours.
    pub palette: Palette,
}

impl Default for DrawOptions {
    fn default() -> Self {
        DrawOptions { shapes: true, contacts: true, joints: true, ..DrawOptions::nothing() }
    }
}

impl DrawOptions {
    /// Nothing, to switch on single elements.
    pub fn nothing() -> Self {
        DrawOptions {
            shapes: false,
            aabbs: false,
            fat_aabbs: false,
            motion: false,
            contacts: false,
            normals: false,
            impulses: false,
            joints: false,
            islands: false,
            centres: false,
            solver_colours: false,
            region: None,
            length: 0.2,
            impulse_scale: 0.01,
            palette: Palette::default(),
        }
    }

    /// Everything.
    pub fn everything() -> Self {
        DrawOptions {
            shapes: true,
            aabbs: true,
            fat_aabbs: true,
            motion: true,
            contacts: true,
            normals: true,
            impulses: true,
            joints: true,
            centres: true,
            solver_colours: true,
            ..DrawOptions::nothing()
        }
    }

    /// Only within a box.
    pub fn within(mut self, region: Region) -> Self {
        self.region = Some(region);
        self
    }
}

/// A box of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Its low corner [m].
    pub min: DVec3,
    /// Its high corner [m].
    pub max: DVec3,
}

impl Region {
    /// A cube around a point, reaching so far to each side [m].
    pub fn around(centre: DVec3, reach: f64) -> Region {
        Region { min: centre - reach, max: centre + reach }
    }

    pub(super) fn meets(&self, min: DVec3, max: DVec3) -> bool {
        (self.min.cmple(max) & self.max.cmpge(min)).all()
    }

    pub(super) fn holds(&self, point: DVec3) -> bool {
        self.meets(point, point)
    }
}

/// A colour as screens have it (sRGB).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Colour {
    /// 0 to 255.
    pub red: u8,
    /// 0 to 255.
    pub green: u8,
    /// 0 to 255.
    pub blue: u8,
}

impl Colour {
    /// From red, green and blue.
    pub const fn new(red: u8, green: u8, blue: u8) -> Colour {
        Colour { red, green, blue }
    }

    /// Red, green and blue in 0..=1, still sRGB.
    pub fn to_array(self) -> [f32; 3] {
        [self.red, self.green, self.blue].map(|c| f32::from(c) / 255.0)
    }

    /// One of many that are easy to tell apart: hues a golden angle from each other, brighter and darker in
    /// turn.
    pub(super) fn nth(n: usize) -> Colour {
        let hue = (n as f32 * 0.618_034).fract() * 6.0;
        let light = if n.is_multiple_of(2) { 1.0 } else { 0.75 };
        let channel = |at: f32| {
            let away = (hue - at).abs().min(6.0 - (hue - at).abs());
            (light * (50.0 + 205.0 * (2.0 - away).clamp(0.0, 1.0))) as u8
        };
        Colour::new(channel(0.0), channel(2.0), channel(4.0))
    }
}

/// The colours of a palette, each by its name, with their defaults.
macro_rules! palette {
    ($($name:ident: $red:literal $green:literal $blue:literal,)*) => {
        /// Colours of drawn elements.
        #[derive(Clone, Debug, PartialEq, Eq)]
        #[allow(missing_docs, reason = "each is named for what it is the colour of")]
        pub struct Palette {
            $(pub $name: Colour,)*
            /// Colours of the axes of frames and of principal axes: x, y and z.
            pub axes: [Colour; 3],
        }

        impl Default for Palette {
            fn default() -> Self {
                Palette {
                    $($name: Colour::new($red, $green, $blue),)*
                    axes: [Colour::new(230, 80, 70), Colour::new(95, 195, 90), Colour::new(80, 130, 240)],
                }
            }
        }
    };
}

palette! {
    static_body: 140 145 152,
    kinematic_body: 90 170 160,
    dynamic_body: 225 165 85,
    sleeping_body: 125 110 90,
    aabb: 120 205 120,
    fat_aabb: 60 125 75,
    motion: 255 225 70,
    real_point: 255 60 50,
    potential_point: 70 150 255,
    ghost_point: 255 70 230,
    gap: 170 200 255,
    normal: 235 235 235,
    impulse: 255 150 40,
    joint_limit: 190 150 255,
    joint_gap: 255 60 50,
    coupling: 255 200 80,
    centre_of_mass: 255 255 255,
}
