//! What a run leaves behind. Nothing is measured or drawn here.
