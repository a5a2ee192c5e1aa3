#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/problem.hpp>

namespace busbar::controller::detail {

/// A file of a bundle, or one that could not be added to it.
struct BundleEntry {
    enum class Kind : std::uint8_t { File, Missing };

    Kind kind{Kind::File};
    std::string_view name{};
    /// The bytes of the file, or why they are missing.
    std::string_view text{};
};

/// The files of a program as one text: a first line, and for each file a line with its kind, its
/// size and its name, followed by its bytes and a line feed.
class BundleWriter {
public:
    /// The name has no line feed.
    void add(BundleEntry::Kind kind, std::string_view name, std::string_view text);
    [[nodiscard]] std::size_t size() const { return text_.size(); }
    [[nodiscard]] std::string take() { return std::move(text_); }

private:
    std::string text_{};
};

[[nodiscard]] bool is_bundle(std::string_view text);
/// Returns the entries, which refer to the text. `file_name` is for the problem with a damaged one.
[[nodiscard]] Configured<std::vector<BundleEntry>> read_bundle(std::string_view text,
                                                               std::string_view file_name);

/// More files are refused.
inline constexpr std::size_t max_bundle_files = 10'000;
/// Longer names are refused, in bytes.
inline constexpr std::size_t max_bundle_name = 4'096;
/// A longer text of a missing file is refused, in bytes.
inline constexpr std::size_t max_missing_text = 1'024;

} // namespace busbar::controller::detail
