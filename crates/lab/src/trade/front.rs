//! The Pareto front of many settings.

use std::cmp::Ordering;

/// The Pareto front of points (cost, error): points for which no other is cheaper without a greater error,
/// the cheapest first. Only the first of equal points is included, and no point that is not finite.
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut all: Vec<usize> = (0..points.len()).filter(|&i| is_finite(&points[i])).collect();
    all.sort_by(|&i, &j| by_cost(&points[i], &points[j]).then(i.cmp(&j)));
    let mut least = f64::INFINITY;
    all.retain(|&i| {
        let better = points[i][1] < least;
        least = least.min(points[i][1]);
        better
    });
    all
}

/// The cheapest point whose error is no greater than this.
pub fn cheapest_within(points: &[[f64; 2]], max_error: f64) -> Option<usize> {
    let fits = |&i: &usize| is_finite(&points[i]) && points[i][1] <= max_error;
    (0..points.len()).filter(fits).min_by(|&i, &j| by_cost(&points[i], &points[j]))
}

/// The point with the least error whose cost is no greater than this.
pub fn best_within(points: &[[f64; 2]], budget: f64) -> Option<usize> {
    let fits = |&i: &usize| is_finite(&points[i]) && points[i][0] <= budget;
    let swapped = |i: usize| [points[i][1], points[i][0]];
    (0..points.len()).filter(fits).min_by(|&i, &j| by_cost(&swapped(i), &swapped(j)))
}

fn is_finite(point: &[f64; 2]) -> bool {
    point.iter().all(|x| x.is_finite())
}

fn by_cost(a: &[f64; 2], b: &[f64; 2]) -> Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 1 and 4 are dominated, 5 is the twin of 2, 6 and 7 are not finite.
    const POINTS: [[f64; 2]; 8] = [
        [1.0, 9.0],
        [2.0, 9.0],
        [3.0, 4.0],
        [8.0, 1.0],
        [9.0, 2.0],
        [3.0, 4.0],
        [0.5, f64::INFINITY],
        [f64::NAN, 0.0],
    ];

    #[test]
    fn the_front_has_what_nothing_dominates() {
        assert_eq!(front(&POINTS), [0, 2, 3]);
        assert!(front(&[]).is_empty());
    }

    /// By the definition: a point is dominated if another is no worse in both and better in one, or equal and
    /// earlier.
    #[test]
    fn the_front_is_that_of_its_definition() {
        let mut random = crate::random::Random(5);
        // Few values, so that many points are equal.
        let mut value = || f64::from((random.range(0.0, 8.0)).floor());
        let points: Vec<[f64; 2]> = (0..60).map(|_| [value(), value()]).collect();
        let dominates = |j: usize, i: usize| {
            let (a, b) = (points[j], points[i]);
            a[0] <= b[0] && a[1] <= b[1] && (a != b || j < i)
        };
        let mut expected: Vec<usize> =
            (0..points.len()).filter(|&i| (0..points.len()).all(|j| j == i || !dominates(j, i))).collect();
        expected.sort_by(|&i, &j| points[i][0].total_cmp(&points[j][0]));
        assert_eq!(front(&points), expected);
    }

    #[test]
    fn picks_keep_their_bound() {
        assert_eq!(cheapest_within(&POINTS, 4.0), Some(2));
        assert_eq!(cheapest_within(&POINTS, 3.9), Some(3));
        assert_eq!(cheapest_within(&POINTS, 0.9), None);
        assert_eq!(best_within(&POINTS, 8.5), Some(3));
        assert_eq!(best_within(&POINTS, 2.5), Some(0));
        assert_eq!(best_within(&POINTS, 0.9), None);
    }
}
