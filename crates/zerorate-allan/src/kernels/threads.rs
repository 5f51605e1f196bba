//! Work that splits into numbered pieces. The result does not depend on how many threads share it. A browser has one
//! thread, and code for more would add a tenth to the download.

use alloc::vec::Vec;

/// Runs both closures, at the same time if a thread is free, and returns their results.
#[cfg(all(feature = "std", not(target_family = "wasm")))]
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

#[cfg(any(not(feature = "std"), target_family = "wasm"))]
pub fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Runs `f(0)`, `f(1)` … on all threads, and returns their results in this order.
#[cfg(all(feature = "std", not(target_family = "wasm")))]
pub fn map<R: Send>(pieces: usize, f: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    (0..pieces).into_par_iter().map(f).collect()
}

#[cfg(any(not(feature = "std"), target_family = "wasm"))]
pub fn map<R>(pieces: usize, f: impl Fn(usize) -> R) -> Vec<R> {
    (0..pieces).map(f).collect()
}

/// As [`map`], with a value that each thread reuses.
#[cfg(all(feature = "std", not(target_family = "wasm")))]
pub(super) fn map_with<S, R: Send>(
    pieces: usize,
    start: impl Fn() -> S + Sync + Send,
    f: impl Fn(&mut S, usize) -> R + Sync + Send,
) -> Vec<R> {
    use rayon::prelude::*;
    (0..pieces).into_par_iter().map_init(start, f).collect()
}

#[cfg(any(not(feature = "std"), target_family = "wasm"))]
pub(super) fn map_with<S, R>(pieces: usize, start: impl Fn() -> S, f: impl Fn(&mut S, usize) -> R) -> Vec<R> {
    let mut kept = start();
    (0..pieces).map(|piece| f(&mut kept, piece)).collect()
}

/// Fills `out` in pieces of `size` elements, the last of which may be shorter.
#[cfg(all(feature = "std", not(target_family = "wasm")))]
pub(super) fn fill<T: Send>(out: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    use rayon::prelude::*;
    out.par_chunks_mut(size).enumerate().for_each(|(piece, out)| f(piece, out));
}

#[cfg(any(not(feature = "std"), target_family = "wasm"))]
pub(super) fn fill<T>(out: &mut [T], size: usize, f: impl Fn(usize, &mut [T])) {
    out.chunks_mut(size).enumerate().for_each(|(piece, out)| f(piece, out));
}
