#pragma once

#include <string>
#include <string_view>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/self_signed.hpp>

namespace busbar::administration::detail {

/// Replaces the fields of `subject` by those of a subject name: "CN=Press 4/O=Works", separated by
/// "/" or ",", with a value that has one of these in double quotes (Part 12, 7.9.4). An empty text
/// changes nothing. Bad_InvalidArgument for any other text.
[[nodiscard]] Checked<crypto::CertificateSubject> with_names(crypto::CertificateSubject subject,
                                                             std::string_view text);

/// Writes the names of a subject as with_names() reads them; empty if it has none.
[[nodiscard]] std::string text_of_names(const crypto::CertificateSubject& subject);

} // namespace busbar::administration::detail
