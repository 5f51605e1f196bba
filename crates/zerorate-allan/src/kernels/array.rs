//! Large arrays. On Linux they use large pages: to touch a new array in small pages costs as much as the sums over it.

#[cfg(all(feature = "std", target_os = "linux"))]
pub(super) use pages::{Array, Number};

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

    impl<T: Number> Array<T> {
        pub fn zeroed(len: usize) -> Self {
            let bytes = len * size_of::<T>();
            let pages = (bytes >= LARGE).then(|| MmapMut::map_anon(bytes)).and_then(Result::ok);
            let Some(pages) = pages else { return Self::Heap(vec![T::zeroed(); len]) };
            // small pages work as well
            pages.advise(Advice::HugePage).ok();
            Self::Pages(pages)
        }
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
pub(super) use heap::{Array, Number};

#[cfg(not(all(feature = "std", target_os = "linux")))]
mod heap {
    use alloc::vec;
    use alloc::vec::Vec;
    use core::ops::{Deref, DerefMut};

    pub(in super::super) trait Number: Copy + Default {}
    impl<T: Copy + Default> Number for T {}

    pub(in super::super) struct Array<T>(Vec<T>);

    impl<T: Number> Array<T> {
        pub fn zeroed(len: usize) -> Self {
            Self(vec![T::default(); len])
        }
    }

    impl<T> Deref for Array<T> {
        type Target = [T];

        fn deref(&self) -> &[T] {
            &self.0
        }
    }

    impl<T> DerefMut for Array<T> {
        fn deref_mut(&mut self) -> &mut [T] {
            &mut self.0
        }
    }
}
