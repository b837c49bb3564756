//! One list of a store's buffers, from which the bytes that it holds, lacks and reserves follow.

use super::{Buffer, bytes_of};

/// Makes the functions of a store that go through its buffers from one list of them:
///
/// ```text
/// buffers! {
///     Statics {
///         /// For each dynamic body.
///         each(dynamic: usize) { places(dynamic), burdens(dynamic) }
///         missing(contacts: usize) { supports(contacts), points(POINTS) }
///         bytes { trail }
///     }
/// }
/// ```
///
/// A buffer is a field that is a vector, or a store with a list of its own. Behind it stands the capacity
/// that it needs, or the arguments of its own list. A group has the name of the method that it makes:
///
/// - `each(n, f)` calls `f` with each buffer and the capacity that it needs;
/// - `missing(n)` says how many bytes the buffers lack for that;
/// - `each_and_missing` makes both;
/// - `bytes` makes neither: these buffers are not reserved in advance.
///
/// Each buffer is in one group; all groups together make `bytes()`, live and reserved.
macro_rules! buffers {
    ($store:ty {
        $(
            $(#[$doc:meta])*
            $group:ident $(($($n:ident: $needs:ty),*))? {
                $($($field:tt).+ $(($($need:expr),*))?),+ $(,)?
            }
        )+
    }) => {
        impl $store {
            $($crate::memory::buffers! {
                @$group [$(#[$doc])*] ($($($n: $needs),*)?) $(($($field).+) ($($($need),*)?))+
            })+

            /// Live and reserved bytes.
            pub(crate) fn bytes(&self) -> (usize, usize) {
                use $crate::memory::List as _;
                $crate::memory::sum_bytes([$($(self.$($field).+.bytes()),+),+])
            }
        }
    };
    (@each [$($doc:tt)*] ($($n:ident: $needs:ty),*) $(($($field:tt)+) ($($need:expr),*))+) => {
        $($doc)*
        pub(crate) fn each(
            &mut self,
            $($n: $needs,)*
            f: &mut dyn FnMut(&mut dyn $crate::memory::Buffer, usize),
        ) {
            use $crate::memory::List as _;
            $(self.$($field)+.each($($need,)* f);)+
        }
    };
    (@missing [$($doc:tt)*] ($($n:ident: $needs:ty),*) $(($($field:tt)+) ($($need:expr),*))+) => {
        $($doc)*
        pub(crate) fn missing(&self, $($n: $needs),*) -> usize {
            use $crate::memory::Buffer as _;
            [$(self.$($field)+.missing($($need),*)),+].iter().sum()
        }
    };
    (@each_and_missing $($list:tt)*) => {
        $crate::memory::buffers! { @each $($list)* }
        $crate::memory::buffers! { @missing $($list)* }
    };
    (@bytes $($list:tt)*) => {};
}
pub(crate) use buffers;

/// Leaves wrong values in a list of a step that is over. In builds with assertions each step begins with such
/// lists: if it read one before it is written, its bits would not be those of a build without.
#[cfg(debug_assertions)]
pub(crate) fn spoil<T>(list: &mut Vec<T>) {
    if list.len() < 2 { list.clear() } else { list.reverse() }
}

/// A vector as a store of one buffer, so that lists have both in the same way.
pub(crate) trait List {
    fn bytes(&self) -> (usize, usize);
    fn each(&mut self, len: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize));
}

impl<T> List for Vec<T> {
    fn bytes(&self) -> (usize, usize) {
        bytes_of(self)
    }
    fn each(&mut self, len: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(self, len);
    }
}

#[cfg(test)]
mod tests {
    #[derive(Default)]
    struct Inner {
        all: Vec<u64>,
    }

    buffers! { Inner { each_and_missing(n: usize) { all(n) } } }

    #[derive(Default)]
    struct Outer {
        bodies: Vec<u32>,
        inner: Inner,
        contacts: Vec<u16>,
        found: Vec<u8>,
    }

    buffers! {
        Outer {
            each(bodies: usize) { bodies(bodies), inner(2 * bodies) }
            missing(contacts: usize) { contacts(contacts) }
            bytes { found }
        }
    }

    #[test]
    fn all_that_is_asked_of_a_store_follows_from_its_list() {
        let mut store = Outer { found: vec![1, 2, 3], ..Outer::default() };
        let mut lacking = 0;
        store.each(5, &mut |buffer, len| lacking += buffer.missing(len));
        assert_eq!((lacking, store.missing(7)), (5 * 4 + 10 * 8, 7 * 2));
        store.each(5, &mut |buffer, len| buffer.reserve_total(len));
        assert_eq!((store.inner.missing(10), store.inner.missing(11)), (0, 8));
        assert_eq!(store.bytes(), (3, 3 + lacking));
    }
}
