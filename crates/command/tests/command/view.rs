//! Pictures that the command writes show the scene where it is.
#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use backstop::glam::DVec3;
use backstop::{BodyDesc, Geometry, ShapeDesc};
use backstop_scene::Scene;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn backstop(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_backstop"))
        .args(arguments)
        // No window opens, wherever the test runs.
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .current_dir(scratch("."))
        .output()
        .expect("the command starts")
}

/// A file or folder of this test run.
fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("view");
    std::fs::create_dir_all(&folder).expect("a folder for tests");
    folder.join(name)
}

struct Picture {
    width: u32,
    height: u32,
    rgb: Vec<u8>,
}

impl Picture {
    fn read(path: &Path) -> Picture {
        let file = std::io::BufReader::new(std::fs::File::open(path).expect("a picture"));
        let mut reader = png::Decoder::new(file).read_info().expect("PNG");
        let mut rgb = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut rgb).expect("pixels");
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
        Picture { width: info.width, height: info.height, rgb }
    }

    fn at(&self, x: u32, y: u32) -> [i32; 3] {
        let first = 3 * (y * self.width + x) as usize;
        [0, 1, 2].map(|c| self.rgb[first + c].into())
    }

    /// Middle of the pixels that are wanted, and how many there are.
    fn middle_of(&self, wanted: impl Fn([i32; 3]) -> bool) -> (f64, f64, f64) {
        let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
        for (row, column) in (0..self.height).flat_map(|row| (0..self.width).map(move |c| (row, c))) {
            if wanted(self.at(column, row)) {
                (x, y, count) = (x + f64::from(column) + 0.5, y + f64::from(row) + 0.5, count + 1.0);
            }
        }
        (x / count, y / count, count)
    }
}

fn pictures(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path()).collect();
    files.sort();
    files
}

#[test]
fn pictures_have_their_size_show_something_and_are_the_same_each_time() {
    let run = |name: &str| {
        let folder = scratch(name);
        let to = folder.to_str().expect("a path of characters");
        let frames = ["run", "mass_stack_1e3", "--steps", "6", "--every", "3", "--size", "320x180"];
        let output = backstop(&[&frames[..], &["--frames", to]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).contains(to));
        pictures(&folder)
    };
    let (once, again) = (run("once"), run("again"));
    let names: Vec<_> = once.iter().filter_map(|p| p.file_name()?.to_str()).collect();
    // At the start, and after three and six steps.
    assert_eq!(names, ["frame-00000.png", "frame-00001.png", "frame-00002.png"]);
    for (a, b) in once.iter().zip(&again) {
        assert_eq!(std::fs::read(a).expect("a picture"), std::fs::read(b).expect("a picture"));
        let picture = Picture::read(a);
        assert_eq!((picture.width, picture.height), (320, 180));
        // Boxes, which are blue, in the middle; sky in the corner.
        let (_, _, boxes) = picture.middle_of(|[r, _, b]| b > r + 30);
        assert!(boxes > 300.0, "{boxes}");
    }
}

#[test]
fn a_ball_is_drawn_where_it_is() {
    let mut scene = Scene::new("ball");
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
    scene.add("ball", BodyDesc::dynamic().with_position(DVec3::new(1.0, 6.0, 0.0)).with_shape(ball));
    let file = scratch("ball.gltf");
    backstop_scene::write_scene(&scene, &file).expect("a file");
    let folder = scratch("ball");
    let [file, to] = [&file, &folder].map(|p| p.to_str().expect("a path of characters"));
    let run = ["run", file, "--steps", "40", "--every", "40", "--json", "--frames", to, "--size", "320x240"];
    let look = ["--show", "shapes", "--eye", "0,4,12", "--look-at", "0,4,0"];
    let output = backstop(&[&run[..], &look].concat());
    let document: Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    let height = document["bodies"][0]["position"][1].as_f64().expect("a number");
    assert!(height < 5.0);
    // Level from 12 m: half of the picture's height is 12 m times the tangent of half the angle of view.
    let scale = 120.0 / (12.0 * 0.38f64.tan());
    for (path, y) in pictures(&folder).iter().zip([6.0, height]) {
        let picture = Picture::read(path);
        let (x, row, count) = picture.middle_of(|[r, _, b]| r > b + 30);
        let expected = (160.0 + scale * 1.0, 120.0 - scale * (y - 4.0));
        assert!((x - expected.0).abs() < 1.5 && (row - expected.1).abs() < 1.5, "{x} {row} {expected:?}");
        let disc = std::f64::consts::PI * (0.5 * scale) * (0.5 * scale);
        assert!((count / disc - 1.0).abs() < 0.1, "{count} {disc}");
    }
}

/// A ball of 0.5 m at 6 m over a floor. Expected: where the camera puts itself it sees all of the ball at the
/// start and where it ends: a disc each, of the same size within what perspective does to it.
#[test]
fn the_camera_sees_what_moves_and_where_it_falls() {
    let mut scene = Scene::new("drop");
    let floor = ShapeDesc::new(Geometry::cuboid(20.0, 0.5, 20.0));
    scene.add("floor", BodyDesc::fixed().with_position(DVec3::new(0.0, -0.5, 0.0)).with_shape(floor));
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
    scene.add("ball", BodyDesc::dynamic().with_position(DVec3::new(3.0, 6.0, -2.0)).with_shape(ball));
    let file = scratch("drop.gltf");
    backstop_scene::write_scene(&scene, &file).expect("a file");
    let folder = scratch("drop");
    let [file, to] = [&file, &folder].map(|p| p.to_str().expect("a path of characters"));
    let run = ["run", file, "--steps", "240", "--every", "240", "--frames", to, "--size", "320x240"];
    assert!(backstop(&[&run[..], &["--show", "shapes"]].concat()).status.success());
    let discs = pictures(&folder).into_iter().map(|path| {
        let picture = Picture::read(&path);
        let (x, y, count) = picture.middle_of(|[r, _, b]| r > b + 30);
        let radius = (count / std::f64::consts::PI).sqrt();
        assert!((x - 160.0).abs() < 4.0 && y - radius > 5.0 && y + radius < 235.0, "{x} {y} {radius}");
        (y, radius)
    });
    let [(high, a), (low, b)] = discs.collect::<Vec<_>>()[..] else { panic!("two pictures") };
    // The two are 5.5 m apart, which with the balls around them fills most of the height.
    assert!(low - high > 110.0 && (a / b - 1.0).abs() < 0.4, "{high} {low} {a} {b}");
}

/// The window library's own error, with a line of its source, came before 301 pictures that nobody had asked
/// for. Expected: one line that says what to do instead, and nothing is written.
#[cfg(target_os = "linux")]
#[test]
fn without_a_display_a_view_says_what_to_do_instead() {
    let record = scratch("unseen.replay");
    let _ = std::fs::remove_file(&record);
    let there = pictures(&scratch("."));
    let record = record.to_str().expect("a path of characters");
    let output =
        backstop(&["run", "chain", "--view", "--every", "50", "--size", "80x60", "--record", record]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), errors.lines().count()), (Some(1), 1), "{errors}");
    assert!(errors.contains("--frames DIR") && errors.contains("--report DIR"), "{errors}");
    assert!(!errors.contains(".rs") && output.stdout.is_empty(), "{errors}");
    assert_eq!(there, pictures(&scratch(".")));
}

/// Contacts and joints buried the figures of the builtin scene. Expected: what is not asked for is not drawn,
/// so the picture is that of shapes alone; with contacts it is another.
#[test]
fn contacts_and_joints_are_drawn_only_if_they_are_asked_for() {
    let last = |name: &str, more: &[&str]| {
        let folder = scratch(name);
        let to = folder.to_str().expect("a path of characters");
        let run = ["run", "chain", "--steps", "30", "--every", "30", "--size", "160x90", "--frames", to];
        assert!(backstop(&[&run[..], more].concat()).status.success());
        std::fs::read(folder.join("frame-00001.png")).expect("a picture")
    };
    let default = last("by-default", &[]);
    assert!(default == last("shapes", &["--show", "shapes,grid"]));
    assert!(default != last("joints", &["--show", "shapes,grid,joints"]));
}

#[test]
fn what_can_not_be_shown_is_refused() {
    for (arguments, reason) in [
        (&["--show", "everything"][..], "none of shapes"),
        (&["--size", "12"], "960x540"),
        (&["--view", "--frames", "x"], "--frames"),
        (&["--frames", "x", "--eye", "1,2,3", "--look-at", "1,2,3"], "--look-at"),
    ] {
        let output = backstop(&[&["run", "chain", "--steps", "1"], arguments].concat());
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && errors.contains(reason), "{errors}");
    }
}
