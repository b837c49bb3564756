//! Sets of up to 64 things, a bit each.

/// The numbers of the bits that are set, upwards.
#[inline(always)]
pub(crate) fn ones(set: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut set = set.into();
    std::iter::from_fn(move || {
        let bit = set.trailing_zeros() as usize;
        (set != 0).then(|| {
            set &= set - 1;
            // It is below 64: so the compiler sees it.
            bit % 64
        })
    })
}

#[cfg(test)]
mod tests {
    use super::ones;

    #[test]
    fn each_bit_is_told_once() {
        assert_eq!(ones(0u32).next(), None);
        assert_eq!(ones(0b1011_0000u8).collect::<Vec<_>>(), [4, 5, 7]);
        assert_eq!(ones(1u64 << 63 | 1).collect::<Vec<_>>(), [0, 63]);
        assert_eq!(ones(u64::MAX).count(), 64);
    }
}
