#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/storage.hpp>

namespace busbar::controller::detail {

/// A file of lines that only grows, on a medium that may fail, be removed and return. Once it is
/// open it ends with a whole line, whatever happened before. Lines end with CR and LF. Not
/// thread-safe; blocks on the medium.
class LineFile {
public:
    /// `storage` must outlive this object. A file of more than `max_size` bytes belongs to another
    /// program.
    LineFile(Storage& storage, std::string name, std::size_t max_size)
        : storage_{&storage}, name_{std::move(name)}, max_size_{max_size}
    {
    }

    /// Opens the file, which need not exist. Cuts an incomplete line off or, without room for that,
    /// completes it. TooLarge: see the constructor.
    [[nodiscard]] Stored<void> open();
    /// Opens the file again if it is closed, was removed or was changed by another program.
    [[nodiscard]] Stored<void> refresh();
    void close() { is_open_ = false; }

    /// Makes the file, empty, unless it exists.
    [[nodiscard]] Stored<void> create();
    /// Appends whole lines. An error closes the file, which may then contain some of them.
    [[nodiscard]] Stored<void> append(std::string_view lines);
    /// Number of lines of the last failed `append` that open() found in the file. Returned once.
    [[nodiscard]] std::size_t take_found();

    /// Renames the file and continues with an empty one.
    [[nodiscard]] Stored<void> move_to(std::string_view name, WhenThere when_there);
    /// Removes the file; succeeds if it does not exist.
    [[nodiscard]] Stored<void> remove();

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] std::size_t lines() const { return lines_; }
    /// The last line without its end; empty if there is none or it is too long to be one of the
    /// log.
    [[nodiscard]] const std::string& last_line() const { return last_line_; }

private:
    [[nodiscard]] Stored<void> scan(std::uint64_t size);
    void scan_bytes(std::string_view bytes);
    [[nodiscard]] Stored<void> mend();
    void find_failed(std::string_view tail);
    void forget();

    Storage* storage_;
    std::string name_;
    std::size_t max_size_;
    bool is_open_{false};
    std::uint64_t size_{0};
    std::size_t lines_{0};
    std::string last_line_;
    std::string unfinished_; // after the last line, at most max_line bytes of it
    std::size_t unfinished_size_{0};
    std::string failed_;         // the lines of the failed append()
    std::uint64_t failed_at_{0}; // their offset
    std::size_t found_{0};
};

} // namespace busbar::controller::detail
