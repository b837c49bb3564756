//! What the order of rows does to a ragdoll that is pressed into a wall by far too strong a motor.
//!
//!     cargo run --release --example orders
//!
//! A figure of 86 kg is pushed at 1 m/s, by its hips, against a mesh without thickness, by motors of 1 to 10
//! kN. Draws `docs/images/orders.svg`: the worst moment of a run of each order, and for all runs how far a
//! joint opened against how far something got into the wall.

use backstop::RowGroup::{
    Contacts, JointLimits, Joints, PotentialContacts, PotentialStaticContacts, SoftJoints, StaticContacts,
};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, Error, Geometry, JointDesc, Limit, Motion, Motor, Order, Settings, ShapeDesc,
    Skeleton, TriangleMesh, World,
};
use std::fmt::Write;
use std::sync::Arc;

/// Substeps and iterations.
const SOLVERS: [(u32, u32); 2] = [(4, 1), (1, 8)];
/// [N]
const FORCES: [f32; 12] = [1e3, 1.2e3, 1.5e3, 1.9e3, 2.3e3, 2.8e3, 3.5e3, 4.3e3, 5.3e3, 6.6e3, 8.1e3, 1e4];
/// Which of them is drawn.
const DRAWN: usize = 11;

/// A capsule: its two ends without caps, and its radius [m].
type Capsule = [DVec3; 3];

/// A run: its order, stretch and depth [mm].
type Dot = (usize, f64, f64);

/// The worst of a run.
#[derive(Default)]
struct Worst {
    /// Widest joint and deepest surface beyond the wall [m].
    stretch: f64,
    depth: f64,
    /// The figure and the ends of its joints when it was deepest.
    capsules: Vec<Capsule>,
    joints: Vec<[DVec3; 2]>,
}

/// Presses for five seconds. The wall is the plane x = 0, and the figure comes from the left.
fn press(order: Order, (substeps, iterations): (u32, u32), force: f32) -> Result<Worst, Error> {
    let mut world = World::new(
        Settings::default().with_order(order).with_substeps(substeps).with_iterations(iterations),
    )?;
    let corners = [[-4.0, -4.0], [6.0, -4.0], [6.0, 4.0], [-4.0, 4.0]].map(|[y, z]| Vec3::new(0.0, y, z));
    let wall = TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])?;
    let wall = ShapeDesc::new(Geometry::Mesh(Arc::new(wall)));
    let wall = world.add_body(&BodyDesc::fixed().with_shape(wall))?;
    let skeleton = Skeleton::humanoid();
    let figure = skeleton.add_to(&mut world, DVec3::NEG_X, Quat::IDENTITY, Vec3::ZERO)?;
    let hips = figure.bodies[0];
    let frames = world.frames_at([wall, hips], world.position(hips)?, Quat::IDENTITY)?;
    let motor = Motor::velocity(Motion::Linear, Axis::X, 1.0, force);
    // On a rail: neither up nor aside.
    let rail = Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::X));
    let pusher = JointDesc::new([wall, hips], frames).with_motor(motor).with_limit(rail);
    // Or the wall that holds the rail would not stop the hips.
    world.add_joint(&pusher.with_collide(true))?;

    let mut worst = Worst::default();
    for _ in 0..300 {
        world.step(1.0 / 60.0)?;
        let mut capsules = Vec::new();
        for (bone, &body) in skeleton.bones.iter().zip(&figure.bodies) {
            let half = 0.5 * (bone.to - bone.from).length() - bone.radius;
            let (at, along) = (world.position(body)?, world.rotation(body)? * Vec3::Y * half);
            let along = along.as_dvec3();
            capsules.push([at - along, at + along, DVec3::splat(bone.radius.into())]);
        }
        let mut joints = Vec::new();
        for &joint in &figure.joints {
            joints.push(world.joint_frames(joint)?.map(|(at, _)| at));
        }
        let stretch = joints.iter().map(|[a, b]| (*b - *a).length()).fold(0.0, f64::max);
        let depth = capsules.iter().map(|[p, q, r]| p.x.max(q.x) + r.x).fold(0.0, f64::max);
        worst.stretch = worst.stretch.max(stretch);
        if depth > worst.depth {
            (worst.depth, worst.capsules, worst.joints) = (depth, capsules, joints);
        }
    }
    Ok(worst)
}

/// Pixels of the view of a figure and of the picture, and pixels a metre.
const VIEW: (f64, f64) = (310.0, 250.0);
const SIZE: (f64, f64) = (960.0, 660.0);
const METRE: f64 = 150.0;
const INK: &str = "#333840";

/// The figure from the front, the wall at its side.
fn draw_figure(svg: &mut String, left: f64, top: f64, worst: &Worst, colour: &str) -> std::fmt::Result {
    let wall = left + 0.8 * VIEW.0;
    // The hips are a metre above the ground.
    let (x, y) = (|p: &DVec3| wall + p.x * METRE, |p: &DVec3| top + 0.5 * VIEW.1 - (p.y - 1.0) * METRE);
    // A picture within the picture cuts off what does not fit.
    let (width, height, beyond) = (VIEW.0, VIEW.1, 0.2 * VIEW.0);
    write!(
        svg,
        "<svg x='{left}' y='{top}' width='{width}' height='{height}' viewBox='{left} {top} {width} {height}'>\
         <rect x='{wall:.1}' y='{top}' width='{beyond:.1}' height='{height}' fill='#f3dfd6'/>"
    )?;
    // What is further away is drawn first.
    let mut capsules = worst.capsules.clone();
    capsules.sort_by(|a, b| (a[0].z + a[1].z).total_cmp(&(b[0].z + b[1].z)));
    // Each has a rim.
    for ([p, q, radius], paint) in capsules.iter().flat_map(|c| [(c, INK), (c, colour)]) {
        let width = 2.0 * radius.x * METRE - if paint == INK { 0.0 } else { 3.0 };
        write!(
            svg,
            "<line x1='{:.1}' y1='{:.1}' x2='{:.1}' y2='{:.1}' stroke='{paint}' stroke-width='{width:.1}' \
             stroke-linecap='round'/>",
            x(p),
            y(p),
            x(q),
            y(q)
        )?;
    }
    for [a, b] in worst.joints.iter().filter(|[a, b]| (*b - *a).length() > 0.005) {
        write!(
            svg,
            "<line x1='{:.1}' y1='{:.1}' x2='{:.1}' y2='{:.1}' stroke='#d00000' stroke-width='4' \
             stroke-linecap='round'/>",
            x(a),
            y(a),
            x(b),
            y(b)
        )?;
    }
    write!(svg, "<path d='M{wall:.1} {top}v{height}' stroke='{INK}' stroke-width='2'/></svg>")
}

fn text(svg: &mut String, x: f64, y: f64, style: &str, text: &str) -> std::fmt::Result {
    writeln!(svg, "<text x='{x:.1}' y='{y:.1}' {style}>{text}</text>")
}
const MIDDLE: &str = "text-anchor='middle'";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [soft, ends, locks] = [SoftJoints, JointLimits, Joints];
    let [a, b, c, d] = [Contacts, PotentialContacts, StaticContacts, PotentialStaticContacts];
    let orders = [
        ("Default", "motors, ends of ranges, locks, contacts, walls", Order::default(), "#56b4e9"),
        (
            "Ranges last",
            "motors, locks, contacts, walls, ends of ranges",
            Order([soft, locks, a, b, c, d, ends]),
            "#009e73",
        ),
        (
            "Reversed",
            "walls, contacts, locks, ends of ranges, motors",
            Order::default().reversed(),
            "#e69f00",
        ),
    ];
    let mut svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' \
         font-family='sans-serif' font-size='13' fill='{INK}'><rect width='{0}' height='{1}' fill='#fff'/>",
        SIZE.0, SIZE.1
    );
    println!("worst joint and worst depth in the wall [mm], by force [kN]");
    let mut dots: [Vec<Dot>; 2] = Default::default();
    for (i, (name, what, order, colour)) in orders.into_iter().enumerate() {
        for (solver, dots) in SOLVERS.into_iter().zip(&mut dots) {
            print!("{name} {solver:?}:");
            for (k, force) in FORCES.into_iter().enumerate() {
                let worst = press(order, solver, force)?;
                let (stretch, depth) = (1e3 * worst.stretch, 1e3 * worst.depth);
                print!(" {:.1}: {stretch:.0}/{depth:.0}", 1e-3 * force);
                dots.push((i, stretch, depth));
                if k == DRAWN && solver == SOLVERS[0] {
                    let left = 10.0 + i as f64 * (VIEW.0 + 5.0);
                    draw_figure(&mut svg, left, 50.0, &worst, colour)?;
                    let middle = left + 0.5 * VIEW.0;
                    text(&mut svg, middle, 22.0, &format!("{MIDDLE} font-size='16'"), name)?;
                    text(&mut svg, middle, 41.0, MIDDLE, what)?;
                    let numbers =
                        format!("joints open by up to {stretch:.0} mm, {depth:.0} mm into the wall");
                    text(&mut svg, middle, 66.0 + VIEW.1, MIDDLE, &numbers)?;
                }
            }
            let (stretch, depth) = median(dots, i);
            println!("; median {stretch:.0}/{depth:.0}");
        }
    }
    for (panel, (dots, (substeps, iterations))) in dots.iter().zip(SOLVERS).enumerate() {
        let title = match (substeps, iterations) {
            (_, 1) => format!("{substeps} substeps of 1 iteration"),
            _ => format!("{iterations} iterations, no substeps"),
        };
        draw_dots(&mut svg, 70.0 + panel as f64 * 470.0, &title, dots, &orders.map(|order| order.3))?;
    }
    svg.push_str("</svg>\n");
    std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/images/orders.svg"), svg)?;
    Ok(())
}

/// Least and most of a logarithmic axis [mm].
const AXIS: (f64, f64) = (0.3, 1000.0);

/// A dot a run, depth over stretch, both logarithmic; and the median of each order, large.
fn draw_dots(svg: &mut String, left: f64, title: &str, dots: &[Dot], colours: &[&str]) -> std::fmt::Result {
    let (top, width, height) = (365.0, 400.0, 235.0);
    let along = |mm: f64| (mm.clamp(AXIS.0, AXIS.1) / AXIS.0).ln() / (AXIS.1 / AXIS.0).ln();
    let (x, y) = (|mm| left + width * along(mm), |mm| top + height * (1.0 - along(mm)));
    text(svg, left + 0.5 * width, top - 10.0, &format!("{MIDDLE} font-size='15'"), title)?;
    for mm in [1.0, 10.0, 100.0, 1000.0] {
        let (x, y, right, bottom) = (x(mm), y(mm), left + width, top + height);
        write!(svg, "<path d='M{x:.1} {top}V{bottom}M{left} {y:.1}H{right}' stroke='#e2e5ea'/>")?;
        text(svg, x, bottom + 17.0, MIDDLE, &mm.to_string())?;
        text(svg, left - 6.0, y + 4.0, "text-anchor='end'", &mm.to_string())?;
    }
    write!(svg, "<rect x='{left}' y='{top}' width='{width}' height='{height}' fill='none' stroke='{INK}'/>")?;
    text(svg, left + 0.5 * width, top + height + 38.0, MIDDLE, "widest joint [mm]")?;
    let (x_name, y_name) = (left - 42.0, top + 0.5 * height);
    let turned = format!("{MIDDLE} transform='rotate(-90 {x_name} {y_name})'");
    text(svg, x_name, y_name, &turned, "deepest into the wall [mm]")?;
    for &(order, stretch, depth) in dots {
        let (x, y) = (x(stretch), y(depth));
        write!(svg, "<circle cx='{x:.1}' cy='{y:.1}' r='4' fill='{}' fill-opacity='0.6'/>", colours[order])?;
    }
    for (order, colour) in colours.iter().enumerate() {
        let (stretch, depth) = median(dots, order);
        let (x, y) = (x(stretch), y(depth));
        write!(
            svg,
            "<circle cx='{x:.1}' cy='{y:.1}' r='10' fill='{colour}' stroke='{INK}' stroke-width='2'/>"
        )?;
    }
    Ok(())
}

/// Medians of the runs of an order.
fn median(dots: &[Dot], order: usize) -> (f64, f64) {
    let of = |value: fn(&Dot) -> f64| {
        let mut all: Vec<f64> = dots.iter().filter(|dot| dot.0 == order).map(value).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    (of(|dot| dot.1), of(|dot| dot.2))
}
