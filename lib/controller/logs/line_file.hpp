#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/storage.hpp>

namespace busbar::controller::detail {

/// A file of lines that only grows, on a medium that may fail, go and come back. Whatever happened
/// to it, once it is open it ends with a whole line. Lines end with CR and LF. One thread at a
/// time; blocks on the medium.
class LineFile {
public:
    /// `storage` must outlive it. A file of more than `max_size` bytes is not ours.
    LineFile(Storage& storage, std::string name, std::size_t max_size)
        : storage_{&storage}, name_{std::move(name)}, max_size_{max_size}
    {
    }

    /// Looks at what is there, which may be nothing. A line that is not whole is cut off; if there
    /// is no room for that, it is ended. TooLarge: see above.
    [[nodiscard]] Stored<void> open();
    /// Opens it anew if somebody changed or removed it, or if it is not open.
    [[nodiscard]] Stored<void> refresh();
    void close() { is_open_ = false; }

    /// Whole lines. After an error the file is closed, and some of them may be in it.
    [[nodiscard]] Stored<void> append(std::string_view lines);
    /// Of the lines that the last `append` failed with, how many open() found in the file. They are
    /// told once.
    [[nodiscard]] std::size_t take_found();

    /// The file gets another name, and an empty one is in its place.
    [[nodiscard]] Stored<void> move_to(std::string_view name, WhenThere when_there);
    /// It is gone. Success if it was not there.
    [[nodiscard]] Stored<void> remove();

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] std::size_t lines() const { return lines_; }
    /// Without its end; empty if there is none or it is longer than any line of ours.
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
    std::string unfinished_; // behind the last line, at most max_line bytes of it
    std::size_t unfinished_size_{0};
    std::string failed_;         // what the last append() wanted
    std::uint64_t failed_at_{0}; // and where
    std::size_t found_{0};
};

} // namespace busbar::controller::detail
