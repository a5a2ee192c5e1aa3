#pragma once

#include <unistd.h>

namespace busbar::storage::detail {

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
    /// Releases the open file to a caller who closes it.
    [[nodiscard]] int release()
    {
        const int value = value_;
        value_ = -1;
        return value;
    }

private:
    int value_;
};

} // namespace busbar::storage::detail
