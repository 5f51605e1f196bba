//! Large arrays. On Linux they use large pages: to touch a new array in small pages costs as much as the sums over it.

#[cfg(all(feature = "std", target_os = "linux"))]
pub(super) use pages::{Array, Number, zeroed};

#[cfg(all(feature = "std", target_os = "linux"))]
mod pages {
    use alloc::vec;
    use alloc::vec::Vec;
    use core::ops::{Deref, DerefMut};
    use memmap2::{Advice, MmapMut};

    pub(in super::super) use bytemuck::Pod as Number;

    /// Least size of an array in large pages, bytes. Smaller arrays stay on the heap.
    const LARGE: usize = 1 << 22;

    pub(in super::super) enum Array<T> {
        Heap(Vec<T>),
        Pages(MmapMut),
    }

    pub(in super::super) fn zeroed<T: Number>(len: usize) -> Array<T> {
        let bytes = len * size_of::<T>();
        let pages = (bytes >= LARGE).then(|| MmapMut::map_anon(bytes)).and_then(Result::ok);
        let Some(pages) = pages else { return Array::Heap(vec![T::zeroed(); len]) };
        // small pages work as well
        pages.advise(Advice::HugePage).ok();
        Array::Pages(pages)
    }

    impl<T: Number> Deref for Array<T> {
        type Target = [T];

        fn deref(&self) -> &[T] {
            match self {
                Self::Heap(numbers) => numbers,
                Self::Pages(pages) => bytemuck::cast_slice(pages),
            }
        }
    }

    impl<T: Number> DerefMut for Array<T> {
        fn deref_mut(&mut self) -> &mut [T] {
            match self {
                Self::Heap(numbers) => numbers,
                Self::Pages(pages) => bytemuck::cast_slice_mut(pages),
            }
        }
    }
}

#[cfg(not(all(feature = "std", target_os = "linux")))]
pub(super) use heap::{Array, Number, zeroed};

#[cfg(not(all(feature = "std", target_os = "linux")))]
mod heap {
    use alloc::vec;
    use alloc::vec::Vec;

    pub(in super::super) trait Number: Copy + Default {}
    impl<T: Copy + Default> Number for T {}

    pub(in super::super) type Array<T> = Vec<T>;

    pub(in super::super) fn zeroed<T: Number>(len: usize) -> Array<T> {
        vec![T::default(); len]
    }
}
