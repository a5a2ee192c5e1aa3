#include "program_bundle.hpp"

#include <charconv>
#include <optional>

namespace busbar::controller::detail {

namespace {

constexpr std::string_view first_line = "%busbar program of several files, 1\n";
constexpr std::string_view file_word = "file ";
constexpr std::string_view missing_word = "missing ";

/// Takes an entry off the front of `rest`; nothing if it is damaged.
std::optional<BundleEntry> take_entry(std::string_view& rest)
{
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) {
        return {};
    }
    std::string_view line = rest.substr(0, end);
    BundleEntry entry;
    entry.kind = line.starts_with(file_word) ? BundleEntry::Kind::File : BundleEntry::Kind::Missing;
    const std::string_view word = entry.kind == BundleEntry::Kind::File ? file_word : missing_word;
    if (!line.starts_with(word)) {
        return {};
    }
    line.remove_prefix(word.size());
    std::size_t size = 0;
    const char* const after = line.data() + line.size();
    const auto read = std::from_chars(line.data(), after, size);
    rest.remove_prefix(end + 1);
    if (read.ec != std::errc{} || read.ptr == after || *read.ptr != ' ' || size >= rest.size() ||
        rest[size] != '\n') {
        return {};
    }
    entry.name = line.substr(static_cast<std::size_t>(read.ptr - line.data()) + 1);
    if (entry.name.empty()) {
        return {};
    }
    entry.text = rest.substr(0, size);
    rest.remove_prefix(size + 1);
    return entry;
}

bool is_small(const BundleEntry& entry)
{
    return entry.name.size() <= max_bundle_name &&
           (entry.kind == BundleEntry::Kind::File || entry.text.size() <= max_missing_text);
}

} // namespace

void BundleWriter::add(BundleEntry::Kind kind, std::string_view name, std::string_view text)
{
    text_ += text_.empty() ? first_line : std::string_view{};
    text_ += kind == BundleEntry::Kind::File ? file_word : missing_word;
    text_ += std::to_string(text.size()) + " ";
    text_ += name;
    text_ += '\n';
    text_ += text;
    text_ += '\n';
}

bool is_bundle(std::string_view text)
{
    return text.starts_with(first_line);
}

Configured<std::vector<BundleEntry>> read_bundle(std::string_view text, std::string_view file_name)
{
    std::vector<BundleEntry> entries;
    for (std::string_view rest = text.substr(first_line.size()); !rest.empty();) {
        const auto entry = take_entry(rest);
        if (!entry) {
            return misconfigured(std::string{file_name},
                                 "is damaged after file " + std::to_string(entries.size()) +
                                     " of it; expected several files as busbar writes them");
        }
        if (entries.size() == max_bundle_files) {
            return misconfigured(std::string{file_name},
                                 "has more than " + std::to_string(max_bundle_files) + " files");
        }
        if (!is_small(*entry)) {
            return misconfigured(std::string{file_name},
                                 "has too long a text for file " +
                                     std::to_string(entries.size() + 1) +
                                     " of it; expected a name of at most " +
                                     std::to_string(max_bundle_name) + " bytes, and at most " +
                                     std::to_string(max_missing_text) + " about a missing file");
        }
        entries.push_back(*entry);
    }
    return entries;
}

} // namespace busbar::controller::detail
