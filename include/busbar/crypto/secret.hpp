#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::crypto {

/// Overwrites `bytes` in a way that the compiler cannot leave out.
BUSBAR_API void cleanse(std::span<std::byte> bytes);

/// Bytes of a key or password: move-only, overwritten when it is destroyed.
class Secret {
public:
    Secret() = default;
    explicit Secret(std::size_t size) : bytes_(size) {}
    explicit Secret(std::span<const std::byte> bytes) : bytes_(bytes.begin(), bytes.end()) {}
    explicit Secret(std::string_view text)
        : Secret{std::as_bytes(std::span<const char>{text.data(), text.size()})}
    {
    }
    Secret(const Secret&) = delete;
    Secret& operator=(const Secret&) = delete;
    Secret(Secret&& other) noexcept : bytes_{std::exchange(other.bytes_, {})} {}
    Secret& operator=(Secret&& other) noexcept
    {
        cleanse(bytes_);
        bytes_ = std::exchange(other.bytes_, {});
        return *this;
    }
    ~Secret() { cleanse(bytes_); }

    [[nodiscard]] std::span<const std::byte> span() const { return bytes_; }
    [[nodiscard]] std::span<std::byte> span() { return bytes_; }
    [[nodiscard]] std::string_view text() const
    {
        return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
    }
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }
    [[nodiscard]] bool empty() const { return bytes_.empty(); }

private:
    std::vector<std::byte> bytes_;
};

/// True if both are the same, in a time that depends on their sizes only.
[[nodiscard]] BUSBAR_API bool equal_in_constant_time(std::span<const std::byte> a,
                                                     std::span<const std::byte> b);

} // namespace busbar::crypto
