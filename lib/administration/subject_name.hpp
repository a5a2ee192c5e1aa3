#pragma once

#include <string>
#include <string_view>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/self_signed.hpp>

namespace busbar::administration::detail {

/// `subject` with the fields of a subject name instead of its own: "CN=Press 4/O=Works", parted by
/// "/" or ",", a value with one of these in double quotes (Part 12, 7.9.4). An empty text leaves it
/// as it is. Bad_InvalidArgument for anything else.
[[nodiscard]] Checked<crypto::CertificateSubject> with_names(crypto::CertificateSubject subject,
                                                             std::string_view text);

/// The names of a subject as with_names() reads them; empty if it has none.
[[nodiscard]] std::string text_of_names(const crypto::CertificateSubject& subject);

} // namespace busbar::administration::detail
