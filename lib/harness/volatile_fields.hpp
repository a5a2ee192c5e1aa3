#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/harness/recorded_messages.hpp>

namespace busbar::harness::detail {

/// Says how a field of a message differs from run to run.
enum class Variability : std::uint8_t {
    /// It does not.
    None,
    /// One side chooses it, and both mean the same by it afterwards.
    Id,
    /// A time.
    Time,
    /// It has no meaning beyond its message: handles, nonces, signatures, certificates, URLs.
    Noise
};

/// Returns the last name of a path, without an index.
[[nodiscard]] std::string_view last_name(std::string_view path);
/// Returns how a field differs from run to run.
[[nodiscard]] Variability variability_of(const RecordedMessage::Field& field);
/// Returns what ids with this name stand for: "subscription" for "subscriptionId" and
/// "subscriptionIds".
[[nodiscard]] std::string_view kind_of_id(std::string_view path);

/// Gives ids names in the order in which they come.
class Symbols {
public:
    /// Returns the field's text, or a symbol if it differs from run to run.
    [[nodiscard]] std::string of(const RecordedMessage::Field& field);

private:
    std::map<std::pair<std::string, std::string>, std::size_t> known_;
    std::map<std::string, std::size_t, std::less<>> counts_;
};

} // namespace busbar::harness::detail
