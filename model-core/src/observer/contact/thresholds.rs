//! Thresholds of the contact detection.

use crate::numbers::thresholds;

thresholds! {
    /// Contact by the mesh force (`force_contact`).
    CONTACT: ContactThresholds {
        /// Control periods for which the force must indicate a changed contact before the change is accepted. Derived:
        /// force noise of one period, which the filter carries into the next period, then makes no contact. Checked by
        /// `observer gap`.
        persistence: u8 = 3,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [CONTACT.list()].concat()
}
