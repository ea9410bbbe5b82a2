//! Reports of a recorded run: HTML and JSON. Nothing is measured here.
