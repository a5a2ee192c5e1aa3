#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/problem.hpp>

namespace busbar::controller::detail {

[[nodiscard]] inline std::string_view as_text(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
[[nodiscard]] inline std::span<const std::byte> as_data(std::string_view text)
{
    return std::as_bytes(std::span{text});
}

/// Writes a tar of regular files (POSIX.1-2017, pax, "pax Interchange Format"). A file has an
/// extended header only if its name does not fit into an ordinary one. The same calls give the same
/// bytes: files belong to root, and only their owner may read them.
class TarWriter {
public:
    /// Every file gets this time of its last change, in seconds since 1970. Times that a header
    /// cannot hold become the nearest that it can.
    explicit TarWriter(std::int64_t modified);

    /// Bytes that `add` appends.
    [[nodiscard]] static std::size_t size_of(std::string_view name, std::size_t size);
    /// Bytes that `take` appends.
    static constexpr std::size_t end_size = 1'024;

    void reserve(std::size_t size) { file_.reserve(size); }
    /// `name` is a path without NUL, of at most 2,000 bytes.
    void add(std::string_view name, std::span<const std::byte> bytes);
    [[nodiscard]] std::vector<std::byte> take();

private:
    void append_header(std::string_view name, std::size_t size, char type);
    void append(std::span<const std::byte> bytes);

    std::int64_t modified_;
    std::vector<std::byte> file_;
};

struct TarFile {
    std::string name;
    std::span<const std::byte> bytes; // of the tar
};

/// Reads a tar of regular files, file by file, and refuses everything else: folders, links,
/// devices, other formats, extended headers with more than a path, and bytes that are not zero
/// where nothing may be. Owner, rights and times are not looked at. Names are as they were found:
/// the caller checks them.
class TarReader {
public:
    /// `tar` must outlive the reader and the files.
    explicit TarReader(std::span<const std::byte> tar) : tar_{tar} {}

    /// Whether this begins as a tar does.
    [[nodiscard]] static bool is_tar(std::span<const std::byte> bytes);

    /// Returns the next file, or nothing after the last one.
    [[nodiscard]] Configured<std::optional<TarFile>> next();

private:
    struct Entry {
        char type;
        std::string name;
        std::span<const std::byte> bytes;
    };

    [[nodiscard]] Configured<std::optional<Entry>> next_entry();
    [[nodiscard]] Configured<void> check_end() const;
    [[nodiscard]] Configured<std::span<const std::byte>> take_bytes(std::size_t size);
    [[nodiscard]] Unexpected<Problem> refuse(const std::string& found) const;

    std::span<const std::byte> tar_;
    std::size_t at_{0};
};

} // namespace busbar::controller::detail
