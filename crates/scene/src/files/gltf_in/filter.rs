//! Collision systems by name to bits.
//!
//! A filter that lists `collideWithSystems` collides with colliders in any of them; one that lists
//! `notCollideWithSystems` with those in any other system. A collider in no system counts as in every one:
//! it is kept apart only by lists that name all. A filter with both lists collides with those in a system
//! that the first names and the second doesn't. Both filters of a pair have to agree.

use super::extension;
use backstop::Filter;

/// There are more systems than bits.
#[derive(Debug, PartialEq)]
pub(super) struct TooMany;

/// A bit for each system, in the order in which the file names them.
pub(super) fn filters(filters: &[extension::Filter]) -> Result<Vec<Filter>, TooMany> {
    let mut names: Vec<&str> = Vec::new();
    for filter in filters {
        let lists = [&filter.collide_with_systems, &filter.not_collide_with_systems];
        for name in filter.collision_systems.iter().chain(lists.into_iter().flatten().flatten()) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
            if names.len() > 64 {
                return Err(TooMany);
            }
        }
    }
    let bits = |list: &[String]| {
        let bit = |name: &String| names.iter().position(|n| n == name).map_or(0, |i| 1u64 << i);
        list.iter().map(bit).fold(0, |a, b| a | b)
    };
    let filter = |filter: &extension::Filter| {
        let category = match bits(&filter.collision_systems) {
            0 => u64::MAX,
            systems => systems,
        };
        let mask = match (&filter.collide_with_systems, &filter.not_collide_with_systems) {
            (Some(with), None) => bits(with),
            (Some(with), Some(without)) => bits(with) & !bits(without),
            (None, Some(without)) => !bits(without),
            (None, None) => u64::MAX,
        };
        Filter::default().with_category(category).with_mask(mask)
    };
    Ok(filters.iter().map(filter).collect())
}

/// The filter of a collider without one, in a file that has filters.
pub(super) fn unfiltered() -> Filter {
    Filter::default().with_category(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(names: &[&str]) -> Vec<String> {
        names.iter().map(|n| n.to_string()).collect()
    }

    /// The specification's rule over names, with a list of what to collide with read as "any of them".
    fn by_names(a: &extension::Filter, b: &extension::Filter) -> bool {
        let systems = &a.collision_systems;
        let with = |list: &Vec<String>| systems.is_empty() || systems.iter().any(|s| list.contains(s));
        let without = |list: &Vec<String>| !systems.is_empty() && systems.iter().all(|s| list.contains(s));
        b.collide_with_systems.as_ref().is_none_or(with)
            && !b.not_collide_with_systems.as_ref().is_some_and(without)
    }

    #[test]
    fn bits_collide_as_names_do() {
        let systems = [&[][..], &["a"], &["b"], &["a", "b"], &["c"]];
        let mut all = Vec::new();
        for member in systems {
            for other in systems {
                for mode in 0..3 {
                    all.push(extension::Filter {
                        collision_systems: list(member),
                        collide_with_systems: (mode == 1).then(|| list(other)).filter(|l| !l.is_empty()),
                        not_collide_with_systems: (mode == 2).then(|| list(other)),
                    });
                }
            }
        }
        let bits = filters(&all).unwrap();
        for (i, a) in all.iter().enumerate() {
            for (j, b) in all.iter().enumerate() {
                assert_eq!(bits[i].allows(&bits[j]), by_names(a, b) && by_names(b, a), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn more_than_64_systems_are_refused() {
        let many = |n: usize| extension::Filter {
            collision_systems: (0..n).map(|i| i.to_string()).collect(),
            ..Default::default()
        };
        assert!(filters(&[many(64)]).is_ok());
        assert_eq!(filters(&[many(65)]), Err(TooMany));
    }
}
