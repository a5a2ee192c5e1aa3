#pragma once

#include <cerrno>
#include <cstddef>
#include <optional>
#include <vector>

#include <unistd.h>

namespace busbar::crypto::detail {

/// An open file; -1 if it could not be opened.
class Descriptor {
public:
    explicit Descriptor(int value) : value_{value} {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor()
    {
        if (value_ >= 0) {
            ::close(value_);
        }
    }

    [[nodiscard]] int get() const { return value_; }
    [[nodiscard]] bool is_open() const { return value_ >= 0; }
    /// Leaves it open to somebody else who closes it.
    [[nodiscard]] int release()
    {
        const int value = value_;
        value_ = -1;
        return value;
    }

private:
    int value_;
};

/// The rest of a file; nullopt if it cannot be read or is longer than `max_size`.
inline std::optional<std::vector<std::byte>> read_rest(int file, std::size_t max_size)
{
    std::vector<std::byte> bytes;
    for (;;) {
        std::byte buffer[4'096];
        const ssize_t size = ::read(file, buffer, sizeof buffer);
        if (size < 0 && errno == EINTR) {
            continue;
        }
        if (size < 0 || static_cast<std::size_t>(size) > max_size - bytes.size()) {
            return std::nullopt;
        }
        if (size == 0) {
            return bytes;
        }
        bytes.insert(bytes.end(), buffer, buffer + size);
    }
}

} // namespace busbar::crypto::detail
