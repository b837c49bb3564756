//! Sites in the order of their times: a binary heap in which each site knows its position, so that its time
//! can change.

use super::{NONE, Site};

/// The earliest first, then the fastest, then the lowest index: no two keys are equal.
fn key(sites: &[Site], site: u32) -> (u32, u32, u32) {
    let Site { time, approach, .. } = sites[site as usize];
    // The bits of nonnegative numbers have the same order.
    (time.to_bits(), !approach.to_bits(), site)
}

/// Moves a site to where its time belongs, or removes it if that is infinite. The queue has capacity for all
/// sites.
pub(super) fn update(queue: &mut Vec<u32>, sites: &mut [Site], site: u32) {
    let (time, mut place) = (sites[site as usize].time, sites[site as usize].place as usize);
    if time.is_finite() {
        if place == NONE as usize {
            place = queue.len();
            queue.push(site);
            sites[site as usize].place = place as u32;
        }
        settle(queue, sites, place);
    } else if place != NONE as usize {
        sites[site as usize].place = NONE;
        let last = queue.pop().unwrap_or(site);
        if last != site {
            queue[place] = last;
            sites[last as usize].place = place as u32;
            settle(queue, sites, place);
        }
    }
}

/// Sifts the site at a position up or down.
fn settle(queue: &mut [u32], sites: &mut [Site], mut place: usize) {
    loop {
        let parent = place.saturating_sub(1) / 2;
        if place == 0 || key(sites, queue[parent]) < key(sites, queue[place]) {
            break;
        }
        exchange(queue, sites, place, parent);
        place = parent;
    }
    loop {
        let mut least = place;
        for child in [2 * place + 1, 2 * place + 2] {
            if child < queue.len() && key(sites, queue[child]) < key(sites, queue[least]) {
                least = child;
            }
        }
        if least == place {
            return;
        }
        exchange(queue, sites, place, least);
        place = least;
    }
}

fn exchange(queue: &mut [u32], sites: &mut [Site], x: usize, y: usize) {
    queue.swap(x, y);
    for place in [x, y] {
        sites[queue[place] as usize].place = place as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::super::Link;
    use super::*;

    #[test]
    fn sites_come_out_by_time_whatever_changed() {
        let site = Site {
            first: 0,
            count: 0,
            bodies: [NONE; 2],
            next: [Link::NONE; 2],
            time: f32::INFINITY,
            approach: 0.0,
            place: NONE,
            hits: 0,
            wakeful: true,
        };
        let (mut sites, mut queue) = (vec![site; 100], Vec::new());
        let mut seed = 7u32;
        for i in 0..1000 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let time = if seed >> 30 == 0 { f32::INFINITY } else { (seed >> 26) as f32 };
            let index = (i * 37) % 100;
            (sites[index].time, sites[index].approach) = (time, (seed >> 20 & 7) as f32);
            update(&mut queue, &mut sites, index as u32);
        }
        let waiting = sites.iter().filter(|site| site.time.is_finite()).count();
        let mut last = (0, 0, 0);
        for _ in 0..waiting {
            let first = queue[0];
            let now = key(&sites, first);
            assert!(now > last || last == (0, 0, 0));
            last = now;
            sites[first as usize].time = f32::INFINITY;
            update(&mut queue, &mut sites, first);
        }
        assert!(queue.is_empty() && sites.iter().all(|site| site.place == NONE));
    }
}
