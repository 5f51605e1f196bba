//! A 64-bit division that is small rather than fast. The compiler's own division takes a kilobyte of a
//! microcontroller's flash, a quarter of the whole driver. The driver divides rarely: for a new sampler, for a learned
//! period, for a long gap, and for a sample if a divider is set.

/// Returns ⌊dividend / divisor⌋, or 0 if the divisor is 0. Takes two rounds for each bit of the quotient.
#[inline(never)]
pub(crate) const fn quotient(dividend: u64, divisor: u64) -> u64 {
    if divisor == 0 {
        return 0;
    }
    let (mut part, mut bit) = (divisor, 1);
    while part <= dividend >> 1 {
        part <<= 1;
        bit <<= 1;
    }
    let (mut rest, mut quotient) = (dividend, 0);
    while bit > 0 {
        if part <= rest {
            rest -= part;
            quotient |= bit;
        }
        part >>= 1;
        bit >>= 1;
    }
    quotient
}

#[cfg(test)]
mod tests {
    use super::quotient;

    #[test]
    fn the_quotient_agrees_with_the_division_of_the_host() {
        let edges = |bit: u32| [(1_u64 << bit) - 1, 1 << bit, (1 << bit) + 1, 0x9E37_79B9_7F4A_7C15 >> (63 - bit)];
        for dividend in (0..63).flat_map(edges).chain([u64::MAX]) {
            for divisor in (0..63).flat_map(edges).chain([u64::MAX]).filter(|divisor| *divisor > 0) {
                assert_eq!(quotient(dividend, divisor), dividend / divisor, "{dividend} / {divisor}");
            }
        }
        assert_eq!((quotient(5, 0), quotient(0, 0), quotient(u64::MAX, 0)), (0, 0, 0));
    }
}
