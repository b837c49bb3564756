//! Benchmarks of contact rows, and of loading and storing the records of bodies.

use super::Kernel;
use crate::World;
use crate::constraint::contact::batch::BatchRef;
use crate::constraint::contact::row::{Motion, Pass, Softness, solve};
use crate::constraint::{Batch, FrictionRow, Group, PrepareScratch, Rows, prepare};
use crate::lanes::{GatherLanes, Record, Vec3, f32x8, gather, kernel, scatter, with_best};
use crate::memory::Allowances;
use crate::threads::{Shared, Workers};
use std::hint::black_box;

/// Eight records to lanes and back. There are 512 of them, so that they stay in L1 and no two of a batch are
/// neighbours.
pub fn records() -> Kernel {
    const COUNT: u32 = 512;
    let mut records = vec![Record { linear: glam::Vec3::ONE, ..Record::default() }; COUNT as usize];
    // 67 is odd, so each record occurs once in 512.
    let batches: Vec<[u32; 8]> = (0..COUNT / 8)
        .map(|batch| std::array::from_fn(|lane| (batch * 8 + lane as u32) * 67 % COUNT))
        .collect();
    Kernel::new("gather and scatter of eight", batches.len(), move || {
        for index in &batches {
            with_best!(Wide => move_eight::<Wide>(&mut records, index));
        }
        black_box(&mut records);
    })
}

kernel! {
    fn move_eight<'a, L: GatherLanes>(records: &'a mut [Record], index: &'a [u32; 8]) {
        let step = Vec3::<L>::splat(glam::Vec3::splat(0.001));
        let (v, w) = gather::<L>(|i| records[i], index);
        for (&i, record) in index.iter().zip(scatter(v + step, w - step)) {
            records[i as usize] = record;
        }
    }
}

/// One pass over contacts of four points between two dynamic bodies: with friction, without, and relaxing. An
/// element is a contact, so a batch is eight of them. `wall`: contacts of faces, four points each.
pub fn rows(wall: &dyn Fn() -> World) -> Vec<Kernel> {
    vec![
        pass::<true>("solve, friction and four normals", wall(), false),
        pass::<false>("solve, four normals", wall(), false),
        pass::<true>("relax, friction and four normals", wall(), true),
    ]
}

kernel! {
    /// # Safety
    /// As for [`solve`].
    unsafe fn solve_one<'a, L: GatherLanes, const FRICTION: bool>(
        batch: &'a mut Batch<L, 4, 1>,
        friction: &'a mut FrictionRow<L, 1>,
        motion: &'a Motion<'a, 'a>,
        pass: &'a Pass<'a>,
    ) -> bool {
        // SAFETY: by the contract.
        unsafe { solve::<L, 4, 1, FRICTION>(batch, Some(friction), motion, pass) }
    }
}

fn pass<const FRICTION: bool>(name: &str, mut world: World, relax: bool) -> Kernel {
    let mut rows = std::mem::take(&mut world.buffers.rows);
    let rows = rows.views();
    let mut batches: Vec<(Batch<f32x8, 4, 1>, FrictionRow<f32x8, 1>)> = Vec::new();
    for stage in rows.stages.iter().filter(|s| s.group == Group::Dynamic && !s.serial) {
        let of_stage = &rows.schedule[stage.start as usize..stage.end as usize];
        let both = |of: &BatchRef| {
            let lanes = &rows.two.lanes;
            // SAFETY: there is no other thread.
            unsafe { Some((lanes.p4.read(of.index as usize), *lanes.friction.touching(*of)?)) }
        };
        batches.extend(of_stage.iter().filter(|b| b.points == 4).filter_map(both));
    }
    let movers = world.bodies.movers();
    let mut velocity = world.bodies.velocity[..movers].to_vec();
    let mut delta = vec![Record::default(); movers];
    let mut base = delta.clone();
    let h = 1.0 / 240.0;
    let contacts: u32 = batches.iter().map(|(b, _)| (b.write_a | b.write_b).count_ones()).sum();
    Kernel::new(name, contacts as usize, move || {
        let (rolling, soft) = (Shared::new(&mut []), Shared::new(&mut []));
        let pass = Pass {
            inverse_h: 1.0 / h,
            softness: Softness::new(60.0, 10.0, h),
            push_speed: 3.0,
            load_shift_speed: 0.25,
            touch_distance: crate::config::tuning::TOUCH_DISTANCE,
            friction_box: false,
            relax,
            surfaces: &[],
            rolling: &rolling,
            soft: &soft,
        };
        let base = Shared::new(&mut base);
        // As at the start of a substep; otherwise all would come to rest, and the benchmark would time zeros.
        for v in &mut velocity {
            v.linear.y -= 9.81 * h;
        }
        let (velocity, delta) = (Shared::new(&mut velocity), Shared::new(&mut delta));
        let motion = Motion { velocity: &velocity, delta: &delta, base: &base };
        for (batch, friction) in &mut batches {
            // SAFETY: one thread, one batch at a time; the indices are those of the world that the records
            // are from.
            unsafe {
                with_best!(Wide => {
                    let friction: &mut FrictionRow<Wide, 1> = bytemuck::must_cast_mut(friction);
                    solve_one::<Wide, FRICTION>(batch.cast(), friction, &motion, &pass)
                });
            }
        }
    })
}

/// Sorting, colouring and packing of all contacts of a world.
pub fn preparing(mut world: World) -> Kernel {
    let (mut rows, mut scratch) = (Rows::default(), PrepareScratch::default());
    std::mem::swap(&mut rows, &mut world.buffers.rows);
    let count = world.broad.pairs.iter().filter(|p| p.contact != crate::narrow_phase::NO_CONTACT).count();
    Kernel::new("prepare", count, move || {
        let input = world.prepare_input(world.lengths(1.0 / 60.0), usize::MAX);
        prepare(&Workers::alone(), &input, &mut rows, &mut scratch, &mut Allowances::ENDLESS.clone());
        black_box(&mut rows);
    })
}
