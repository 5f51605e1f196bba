//! Converts C pointers to Rust references.

use crate::status::{Status, ZERORATE_E_NULL, ZERORATE_E_STATE};

/// An object whose memory the caller owns and whose contents are private to this library.
pub trait Object: Sized {
    type State;
    /// The number at the front of the memory, which shows that it was set up as this kind of object.
    const MARK: u32;
}

#[repr(C)]
struct MarkedState<T> {
    mark: u32,
    state: T,
}

/// Writes the mark and the state of an object to its memory.
///
/// # Safety
/// `object` is null or points to writable memory of its type that nothing else uses during the call.
pub unsafe fn set_up<O: Object>(object: *mut O, state: O::State) -> Result<(), Status> {
    const { assert!(size_of::<MarkedState<O::State>>() <= size_of::<O>()) };
    const { assert!(align_of::<MarkedState<O::State>>() <= align_of::<O>()) };
    let place = not_null(object)?.cast::<MarkedState<O::State>>();
    // SAFETY: not null; by the contract writable and large enough, and aligned as the type of the pointer says.
    unsafe { place.write(MarkedState { mark: O::MARK, state }) };
    Ok(())
}

/// Returns the state of an object. Returns ZERORATE_E_NULL for a null pointer, ZERORATE_E_STATE if the mark is wrong.
///
/// # Safety
/// `object` is null or points to readable and writable memory of its type, initialised with any bytes, that nothing
/// else uses during `'a`.
pub unsafe fn state<'a, O: Object>(object: *mut O) -> Result<&'a mut O::State, Status> {
    let marked = not_null(object)?.cast::<MarkedState<O::State>>();
    // SAFETY: not null and readable; the mark lies at the front.
    if unsafe { marked.cast::<u32>().read() } != O::MARK {
        return Err(ZERORATE_E_STATE);
    }
    // SAFETY: the mark says that `set_up` wrote it, and by the contract nobody else uses it.
    Ok(unsafe { &mut (*marked).state })
}

/// Returns the data that a constant pointer points to, or ZERORATE_E_NULL.
///
/// # Safety
/// `data` is null or points to a valid `T` that nothing changes during `'a`.
pub unsafe fn input<'a, T>(data: *const T) -> Result<&'a T, Status> {
    // SAFETY: by the contract.
    unsafe { data.as_ref() }.ok_or(ZERORATE_E_NULL)
}

/// Writes a result, or returns ZERORATE_E_NULL.
///
/// # Safety
/// `place` is null or points to writable memory of its type.
pub unsafe fn output<T>(place: *mut T, value: T) -> Result<(), Status> {
    let place = not_null(place)?;
    // SAFETY: not null, by the contract writable.
    unsafe { place.write(value) };
    Ok(())
}

fn not_null<T>(pointer: *mut T) -> Result<*mut T, Status> {
    if pointer.is_null() { Err(ZERORATE_E_NULL) } else { Ok(pointer) }
}
