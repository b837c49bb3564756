//! `run`: runs a scene from a file and writes its results.

use crate::args::RunOptions;
use crate::files::{Kind, expect_place};
use crate::interrupt;
use crate::report::accuracy::{self, Course};
use crate::report::document::Document;
use crate::report::trace::{SolverSum, Trace};
use crate::report::viewer::{self, Motion};
use crate::report::{output, page, summary};
use crate::settings_file::SettingsFile;
use crate::testbed::serve;
use crate::threads::with_threads;
use anyhow::{Context, bail};
use backstop::{BodyHandle, Budget, ContinuousMode, Settings, World};
use backstop_lab::LabWorld;
use backstop_lab::WorldSolver;
use backstop_lab::retroactive::Retroactive;
use backstop_lab::system::System;
use backstop_scene::{self as scene, AtomicFile, Recorder, Scene};
use backstop_testbed::{FileScene, Session};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Simulated time of scenes from files, unless steps are given [s].
const SECONDS: f32 = 10.0;
/// Length of the steps in which builtin scenes are counted [s].
const SCENE_STEP: f32 = 1.0 / 60.0;
/// Frames of a film, at most [1/s]: viewers interpolate.
const FRAME_RATE: f32 = 60.0;

pub(crate) fn run(options: &RunOptions) -> anyhow::Result<()> {
    // Checked first, so that it fails before the work is done.
    let export_to = options.export()?.map(|(_, path)| path);
    let page = options.report.as_ref().map(|folder| folder.join("index.html"));
    let outputs = [options.out.as_deref(), options.record.as_deref(), page.as_deref(), export_to.as_deref()];
    let inputs = std::iter::once(Path::new(&options.scene)).chain(options.settings.as_deref());
    output::refuse_inputs(&outputs, inputs)?;
    let file = SettingsFile::with(options.settings.as_deref(), &options.set)?;
    let mut scene = output::open(&options.scene, &options.common.limits())?;
    output::refuse_inputs(&outputs, scene.parts.iter().map(PathBuf::as_path))?;
    for (file, kind) in outputs.iter().zip([Kind::Gltf, Kind::Replay, Kind::Page, Kind::Problem]) {
        file.map_or(Ok(()), |file| expect_place(file, kind))?;
    }
    // Rain comes from above, that is, against gravity.
    let of_file = file.has_gravity.then_some(file.world.gravity);
    scene.gravity = options.gravity.or(of_file).unwrap_or(scene.gravity);
    let chosen = Chosen::new(options, &scene, file)?;
    if chosen.solver.is_some() && options.record.is_some() {
        bail!("a run that a method of the lab solves can't be recorded: a recording has no word for it");
    }
    let steps_only = options.record.is_some() || options.view || options.export_problem.is_some();
    if chosen.retroactive.is_some() && steps_only {
        bail!("--retroactive takes steps back, which --record, --view and --export-problem can't");
    }
    if options.drop > 0 {
        scene.rain(options.drop, options.seed);
    }
    for file in [&options.out, &options.record, &export_to].into_iter().flatten() {
        output::make_folder_of(file)?;
    }
    options.report.as_deref().map_or(Ok(()), |folder| output::make_report(folder, &page::CHARTS))?;
    if !options.common.quiet {
        output::notes(&scene);
        if scene.bodies.iter().all(|b| b.desc.kind == backstop::BodyKind::Static) {
            eprintln!("note: nothing moves in this scene; --drop 100 rains bodies onto it");
        }
    }
    if options.view {
        return view(options, &chosen, &scene);
    }
    // Until all is written.
    let _watch = interrupt::watch()?;
    let ran = with_threads(chosen.settings.threads, || simulate(options, &chosen, &scene))?;
    write(options, chosen.dt, &scene, &ran)
}

/// `--view`: in the testbed, until the user ends it.
fn view(options: &RunOptions, chosen: &Chosen, scene: &Scene) -> anyhow::Result<()> {
    // Refused options end the run here.
    start(chosen, scene).with_context(|| format!("scene {} is refused", scene.name))?;
    let (chosen, scene) = (chosen.clone(), scene.clone());
    serve(&options.serve, chosen.settings.threads, Some("file"), move || {
        let about = scene.source.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
        let file = FileScene {
            title: scene.name.clone(),
            about,
            dt: chosen.dt,
            start: Box::new(move || start(&chosen, &scene)),
        };
        Session::new().with_file(file)
    })
}

/// A world with the scene in it, and the names of its bodies.
fn start(chosen: &Chosen, scene: &Scene) -> Result<(World, Vec<(BodyHandle, String)>), backstop::Error> {
    let mut world = World::new(chosen.settings.clone())?;
    world.solve_with(chosen.solver.clone());
    let handles = scene.add_to(&mut world)?.bodies;
    let names = scene.bodies.iter().map(|body| body.name.clone());
    Ok((world, handles.into_iter().zip(names).collect()))
}

/// The motion of a run, for the requested outputs.
struct Films {
    /// For a glTF animation.
    animation: Option<Recorder>,
    /// For the viewer of the report.
    motion: Option<Motion>,
}

impl Films {
    /// Adds the present poses, at `time` [s].
    fn record(&mut self, world: &World, handles: &[BodyHandle], time: f32) {
        if let Some(film) = &mut self.animation {
            film.record(time, |i| {
                // Handles are fresh: nothing was removed.
                let pose = |h| Ok::<_, backstop::Error>((world.position(h)?, world.rotation(h)?));
                pose(handles[i]).unwrap_or_default()
            });
        }
        if let Some(motion) = &mut self.motion {
            motion.add(world, handles, time);
        }
    }
}

/// A scene after its last step.
struct Ran {
    world: World,
    handles: Vec<BodyHandle>,
    trace: Trace,
    films: Films,
    /// The exported problem: its file, and a description.
    exported: Option<(PathBuf, String)>,
}

fn simulate(options: &RunOptions, chosen: &Chosen, scene: &Scene) -> anyhow::Result<Ran> {
    let dt = chosen.dt;
    let mut world = World::new(chosen.settings.clone()).context("these settings are refused")?;
    let recording = options.record.as_deref().map(|path| record(path, &mut world)).transpose()?;
    let added = scene.add_to(&mut world).with_context(|| format!("scene {} is refused", scene.name))?;
    let handles = added.bodies;
    for (body, handle) in scene.bodies.iter().zip(&handles) {
        world.name_recorded(*handle, &body.name);
    }

    let steps = options.steps.unwrap_or_else(|| default_steps(scene, dt));
    let every = ((1.0 / FRAME_RATE) / dt).round().max(1.0) as u32;
    let mut films = Films {
        animation: options.out.as_ref().map(|_| Recorder::new(scene)),
        motion: options.report.as_ref().map(|_| Motion::new(scene, every as f32 * dt)),
    };
    let accuracy = options.accuracy.then(Course::default);
    let sum = |solver: &WorldSolver| SolverSum { method: solver.method.name(), ..SolverSum::default() };
    let solver = chosen.solver.as_ref().map(sum);
    let mut trace = Trace { reports: Vec::new(), energy: Vec::new(), accuracy, solver };
    world.solve_with(chosen.solver.clone());
    world.measure_accuracy(options.accuracy);
    let export_to = options.export()?;
    if let Some((at, _)) = &export_to
        && *at > steps
    {
        bail!("--export-problem wants step {at} of {steps}");
    }
    let mut exported = None;
    films.record(&world, &handles, 0.0);
    let bar = output::progress(!options.common.quiet, steps.into(), "steps");
    for step in 1..=steps {
        let exports = export_to.as_ref().is_some_and(|(at, _)| *at == step);
        if exports {
            world.measure_accuracy(true);
        }
        let report = match chosen.retroactive {
            Some(way) => way.step(&mut world, dt)?.report,
            None => *world.step(dt)?,
        };
        if let (Some(sum), Some(report)) = (&mut trace.solver, world.solver_report()) {
            sum.add(report);
        }
        if let Some(course) = &mut trace.accuracy {
            course.add(&world, scene, &handles);
        }
        if exports && let (Some((_, path)), Some(system)) = (&export_to, world.system()) {
            exported = Some(export(system, path)?);
            world.measure_accuracy(options.accuracy);
        }
        trace.reports.push(report);
        if options.report.is_some() {
            trace.energy.push(world.energy());
        }
        let is_last = step == steps || interrupt::asked();
        if step % every == 0 || is_last {
            films.record(&world, &handles, step as f32 * dt);
        }
        bar.inc(1);
        if is_last {
            break;
        }
    }
    bar.finish_and_clear();
    if let (Some(path), Some(file)) = (&options.record, recording) {
        let about = || format!("can't record into {}", path.display());
        world.stop_recording().with_context(about)?;
        file.commit().with_context(about)?;
    }
    Ok(Ran { world, handles, trace, films, exported })
}

/// Begins to record into a file, which is there once it is committed.
fn record(path: &Path, world: &mut World) -> anyhow::Result<AtomicFile> {
    let about = || format!("can't record into {}", path.display());
    let file = AtomicFile::create(path).with_context(about)?;
    world.start_recording(file.writer().with_context(about)?).with_context(about)?;
    Ok(file)
}

/// Writes the contact problem of the last step; returns the file and a description.
fn export(system: &System, path: &Path) -> anyhow::Result<(PathBuf, String)> {
    let (text, about) = accuracy::export(system).context("the problem of the step can't be written")?;
    let wrote = || format!("can't write {}", path.display());
    let mut file = AtomicFile::create(path).with_context(wrote)?;
    file.write_all(text.as_bytes()).with_context(wrote)?;
    file.commit().with_context(wrote)?;
    Ok((path.to_path_buf(), about))
}

/// Settings of the world and the length of a step: from the command line, else from the file, else the
/// defaults.
#[derive(Clone)]
struct Chosen {
    dt: f32,
    settings: Settings,
    solver: Option<WorldSolver>,
    retroactive: Option<Retroactive>,
}

impl Chosen {
    fn new(options: &RunOptions, scene: &Scene, file: SettingsFile) -> anyhow::Result<Chosen> {
        let solver = options.solver.or(file.solver);
        let solver =
            solver.map(|method| WorldSolver { most_rows: options.solver_rows, ..WorldSolver::new(method) });
        let solver = options.methods.of(solver)?;
        let retroactive = options.returns.of(solver.as_ref().map(|solver| solver.method))?;
        if retroactive.is_some() && options.continuous.is_some_and(|mode| mode != ContinuousMode::Discrete) {
            bail!("--retroactive needs --continuous discrete: by the others no step leaves an overlap");
        }
        let discrete = retroactive.map(|_| ContinuousMode::Discrete);
        let base = file.world;
        let settings = base
            .clone()
            .with_gravity(scene.gravity)
            .with_substeps(options.substeps.unwrap_or(base.substeps))
            .with_iterations(options.iterations.unwrap_or(base.iterations))
            .with_threads(options.threads.unwrap_or(base.threads))
            .with_continuous(options.continuous.or(discrete).unwrap_or(base.continuous))
            .with_continuous_method(options.method.unwrap_or(base.continuous_method))
            .with_sleeping(options.sleep || base.sleeping)
            .with_budget(options.budget.map_or(base.budget, Budget::total));
        Ok(Chosen { dt: options.dt.or(file.dt).unwrap_or(SCENE_STEP), settings, solver, retroactive })
    }
}

pub(crate) fn default_steps(scene: &Scene, dt: f32) -> u32 {
    let seconds = if scene.source.is_some() { SECONDS } else { scene.steps as f32 * SCENE_STEP };
    (seconds / dt).round().max(1.0) as u32
}

fn write(options: &RunOptions, dt: f32, scene: &Scene, ran: &Ran) -> anyhow::Result<()> {
    let Ran { world, handles, trace, films, exported } = ran;
    let mut written = Vec::new();
    if let (Some(path), Some(film)) = (&options.out, &films.animation) {
        scene::write_animation(scene, film, path)?;
        written.push(path.clone());
    }
    written.extend(options.record.clone());
    if let Some((path, about)) = exported {
        if !options.common.quiet {
            eprintln!("note: {}: {about}", path.display());
        }
        written.push(path.clone());
    }
    let document = Document::new(options, dt, scene, world, handles, trace)?;
    if let Some(folder) = &options.report {
        let viewer = films.motion.as_ref().map(|motion| viewer::part(scene, motion)).transpose()?;
        written.push(page::write(folder, &document, trace, viewer)?);
    }
    if options.common.json {
        output::print_json(&document)?;
    } else if !options.common.quiet {
        output::print(&summary::text(&document, trace, &written))?;
    }
    let lost: Vec<&str> = document
        .bodies
        .iter()
        .filter(|b| !b.position.iter().all(|x| x.is_finite()))
        .map(|b| b.name.as_str())
        .collect();
    if let Some(first) = lost.first() {
        bail!(
            "{} of {} bodies have no finite position, {first} among them",
            lost.len(),
            document.bodies.len()
        );
    }
    Ok(())
}
