//! Random joints: three to five planets, both laws, both excitations, both dead zones, ripple, errors, unequal backlash,
//! with a compliance or without. Whatever they are, the reference keeps its books and the core its promises.

mod books;
mod core;
mod digest;
mod random;
