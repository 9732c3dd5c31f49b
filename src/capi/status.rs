//! Status codes and texts of errors.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a call went. `footwork_last_error` has the text of what is not `FOOTWORK_STATUS_OK`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootworkStatus {
    /// It was done.
    Ok = 0,
    /// A pointer that must point somewhere is null.
    NullPointer = 1,
    /// A handle of nothing: zero, closed already, or of something else.
    InvalidHandle = 2,
    /// An array of the wrong size.
    WrongSize = 3,
    /// There is no joint, character or frame of that number.
    OutOfRange = 4,
    /// A value that cannot be: not a number, a text that is not UTF-8, a heading of no length.
    InvalidValue = 5,
    /// Something else must be called first.
    OutOfOrder = 6,
    /// A file that cannot be read, is damaged, or is something else.
    CannotRead = 7,
    /// The policy was trained with another database.
    OtherDatabase = 8,
    /// The policy cannot do this: it is of another task.
    Unsupported = 9,
    /// A defect of the library: please report the text.
    Internal = 10,
}

/// A status and its text.
pub struct Failure {
    status: FootworkStatus,
    text: String,
}

/// A failure of that status.
pub fn failure(status: FootworkStatus, text: impl ToString) -> Failure {
    let text = text.to_string();
    Failure { status, text }
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// Calls what does the work. Its failure, or its panic, becomes a status and this thread's last error.
pub fn guard(call: impl FnOnce() -> Result<(), Failure>) -> FootworkStatus {
    let outcome = catch_unwind(AssertUnwindSafe(call));
    let failed = match outcome {
        Ok(Ok(())) => return FootworkStatus::Ok,
        Ok(Err(failure)) => failure,
        Err(panic) => failure(FootworkStatus::Internal, said(&*panic)),
    };
    let text = CString::new(failed.text.replace('\0', " ")).unwrap_or_default();
    // A thread that ends has nobody left to read it.
    let _ = LAST_ERROR.try_with(|last| last.replace(text));
    failed.status
}

fn said(panic: &dyn Any) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or(panic.downcast_ref::<&str>().copied())
        .unwrap_or("a panic without a message")
}

/// The text of this thread's last failure, UTF-8; empty if there was none. It may be read until this thread's
/// next failure.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_last_error() -> *const c_char {
    let text = LAST_ERROR.try_with(|last| last.borrow().as_ptr());
    text.unwrap_or(c"".as_ptr())
}

/// The version of the library, as `0.1.0`.
#[unsafe(no_mangle)]
pub extern "C" fn footwork_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn panics_become_a_status_and_a_text() {
        let status = guard(|| panic!("number {}", 7));
        // SAFETY: it is this thread's text, and no other failure follows.
        let text = unsafe { CStr::from_ptr(footwork_last_error()) };
        assert_eq!((status, text), (FootworkStatus::Internal, c"number 7"));
    }
}
