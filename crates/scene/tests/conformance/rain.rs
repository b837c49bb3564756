//! Level meshes under a rain of bodies: no centre ever gets through a triangle.

use super::*;
use backstop::ShapeDesc;

/// Triangles of an OBJ file, polygons as fans, binned over x and z.
struct Ground {
    triangles: Vec<[DVec3; 3]>,
    cells: Vec<Vec<u32>>,
    min: DVec3,
    cell: f64,
    columns: usize,
}

impl Ground {
    fn read(path: &Path, turn: Quat) -> Ground {
        let text = std::fs::read_to_string(path).unwrap();
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for line in text.lines() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => {
                    let c: Vec<f32> = words.map(|w| w.parse().unwrap()).collect();
                    points.push((turn * Vec3::new(c[0], c[1], c[2])).as_dvec3());
                }
                Some("f") => {
                    let f: Vec<usize> =
                        words.map(|w| w.split('/').next().unwrap().parse::<usize>().unwrap() - 1).collect();
                    for i in 1..f.len() - 1 {
                        triangles.push([points[f[0]], points[f[i]], points[f[i + 1]]]);
                    }
                }
                _ => {}
            }
        }
        let min = points.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
        let max = points.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
        let columns = 64;
        let cell = (max - min).x.max((max - min).z) / columns as f64 * 1.0001;
        let mut ground = Ground { triangles, cells: vec![Vec::new(); columns * columns], min, cell, columns };
        for (i, t) in ground.triangles.clone().iter().enumerate() {
            let (lo, hi) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
            for c in ground.over(lo, hi) {
                ground.cells[c].push(i as u32);
            }
        }
        ground
    }

    fn over(&self, lo: DVec3, hi: DVec3) -> Vec<usize> {
        let at = |v: f64, from: f64| {
            ((v - from) / self.cell).floor().clamp(0.0, self.columns as f64 - 1.0) as usize
        };
        let (x, z) =
            (at(lo.x, self.min.x)..=at(hi.x, self.min.x), at(lo.z, self.min.z)..=at(hi.z, self.min.z));
        z.flat_map(|z| x.clone().map(move |x| (z, x))).map(|(z, x)| z * self.columns + x).collect()
    }

    /// Height of the highest triangle below a point.
    fn below(&self, p: DVec3) -> Option<f64> {
        let (mut low, mut high) = (p.y - 1e4, p.y);
        self.crossed(p, DVec3::new(p.x, low, p.z))?;
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            match self.crossed(p, DVec3::new(p.x, middle, p.z)) {
                Some(_) => low = middle,
                None => high = middle,
            }
        }
        Some(high)
    }

    /// The triangle that a segment goes through (Möller and Trumbore, 1997), if any.
    fn crossed(&self, from: DVec3, to: DVec3) -> Option<u32> {
        let d = to - from;
        let hit = |i: &u32| {
            let [a, b, c] = self.triangles[*i as usize];
            let (e, f) = (b - a, c - a);
            let p = d.cross(f);
            let det = e.dot(p);
            if det.abs() < 1e-12 {
                return false;
            }
            let s = from - a;
            let u = s.dot(p) / det;
            let q = s.cross(e);
            let (v, t) = (d.dot(q) / det, f.dot(q) / det);
            u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&t)
        };
        self.over(from.min(to), from.max(to))
            .into_iter()
            .find_map(|c| self.cells[c].iter().copied().find(hit))
    }
}

/// Whether a body may roll away on a slope of 20 to 30 %. Round ones do, and a hull of a dozen corners is a
/// wheel without a rim, which at 17 degrees rolls on for ever, even with six spokes: of its speed an impact
/// leaves (0.4 + cos 60°) / 1.4, and to get over the next edge takes a tenth of the rest (McGeer,
/// *Passive Dynamic Walking*, 1990, 2).
fn rolls(shapes: &[ShapeDesc]) -> bool {
    !shapes.iter().all(|s| matches!(s.geometry, Geometry::Box { .. }))
}

/// Runs 20 s of `count` bodies on a mesh, turned as given. If it is `level`, boxes come to rest: the mesh is
/// nowhere as steep as their friction of 0.6.
fn rain_on(file: &str, turn: Quat, count: usize, level: bool) {
    let Some(folder) = data("meshes") else { return };
    let path = folder.join(file);
    let mut scene = load(&path).unwrap();
    scene.bodies[0].desc.rotation = turn;
    scene.rain(count, 7);
    let ground = Ground::read(&path, turn);
    // From 3 m above the body below each, or the fall alone would take half of the time.
    for body in scene.bodies.iter_mut().filter(|b| b.desc.kind == BodyKind::Dynamic) {
        let p = body.desc.position;
        if let Some(height) = ground.below(p) {
            body.desc.position.y = height + 3.0;
        }
    }
    let dt = 1.0 / 60.0;
    let mut run = Run::new(&scene);
    let bodies = run.dynamic();
    let centre = |run: &Run, i: usize| run.world.centre_of_mass(run.bodies[i]).unwrap();
    let mut at: Vec<DVec3> = bodies.iter().map(|&i| centre(&run, i)).collect();
    let mut crossings = Vec::new();
    for step in 0..1200 {
        run.world.step(dt).unwrap();
        for (&i, before) in bodies.iter().zip(&mut at) {
            run.body(i);
            let now = centre(&run, i);
            if let Some(triangle) = ground.crossed(*before, now) {
                let name = &scene.bodies[i].name;
                crossings.push(format!(
                    "{name} at step {step} from {before} to {now} through {triangle}: {:?}",
                    ground.triangles[triangle as usize]
                ));
            }
            *before = now;
        }
    }
    let (mut rest, mut slow, mut fast, mut off) = (0, 0, 0, 0);
    for (k, &i) in bodies.iter().enumerate() {
        let is = run.body(i);
        let far = at[k] + DVec3::new(0.0, -1e4, 0.0);
        match () {
            () if ground.crossed(at[k], far).is_none() => off += 1,
            () if is.at_rest() => rest += 1,
            () if level && !rolls(&scene.bodies[i].desc.shapes) => {
                panic!("{} is not at rest: {is:?}", scene.bodies[i].name)
            }
            () if is.linear.length() < 1.0 => slow += 1,
            () => fast += 1,
        }
    }
    println!("{file}: {rest} at rest, {slow} slower than 1 m/s, {fast} faster, {off} over the edge");
    assert!(crossings.is_empty(), "{} crossings:\n{}", crossings.len(), crossings.join("\n"));
}

/// From Blender's z-up to y-up.
fn upright() -> Quat {
    Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)
}

#[test]
fn nothing_falls_through_the_collision_mesh() {
    rain_on("collision_mesh_01.obj", upright(), 100, true);
}

#[test]
fn nothing_falls_through_the_voxel_mesh() {
    rain_on("voxel_mesh_01.obj", upright(), 100, true);
}

/// As the files are: the ground then is a steep slope.
#[test]
fn nothing_falls_through_a_mesh_on_its_side() {
    rain_on("collision_mesh_01.obj", Quat::IDENTITY, 100, false);
    rain_on("voxel_mesh_01.obj", Quat::IDENTITY, 100, false);
}
