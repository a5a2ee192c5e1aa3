#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/crypto/digest.hpp>
#include <controller/life/checksum.hpp>

namespace busbar::test {

using BackupBytes = std::vector<std::byte>;

/// The file with the CRC-32 of version 1 after it.
inline BackupBytes sealed_earlier(std::span<const std::byte> content)
{
    BackupBytes file{content.begin(), content.end()};
    const std::uint32_t sum = controller::detail::checksum(file);
    for (unsigned i = 0; i < 4; ++i) {
        file.push_back(static_cast<std::byte>(sum >> (8 * i) & 0xFFU));
    }
    return file;
}

/// The blocks of a tar, so that a test can change one and make all checksums right again. Takes any
/// bytes.
class TarBlocks {
public:
    static constexpr std::size_t size = 512;

    explicit TarBlocks(BackupBytes tar) : tar_{std::move(tar)} {}

    /// Where the headers are, those of extended headers too.
    [[nodiscard]] std::vector<std::size_t> headers() const
    {
        std::vector<std::size_t> found;
        for (std::size_t at = 0; at + size <= tar_.size() && !is_zero(at);) {
            found.push_back(at);
            at += size + (content(at).size() + size - 1) / size * size;
        }
        return found;
    }
    [[nodiscard]] std::span<const std::byte> content(std::size_t header) const
    {
        std::size_t length = 0;
        for (std::size_t i = 124; i < 135; ++i) {
            const std::size_t digit = std::to_integer<std::size_t>(tar_[header + i]) - '0';
            length = digit < 8 && length < tar_.size() ? length * 8 + digit : length;
        }
        const auto rest = std::span{tar_}.subspan(header + size);
        return rest.first(std::min(length, rest.size()));
    }
    [[nodiscard]] std::string text(std::size_t at, std::size_t length) const
    {
        const std::string field{reinterpret_cast<const char*>(tar_.data()) + at, length};
        return field.substr(0, field.find('\0'));
    }
    void put(std::size_t at, std::string_view text)
    {
        for (std::size_t i = 0; i < text.size() && at + i < tar_.size(); ++i) {
            tar_[at + i] = static_cast<std::byte>(text[i]);
        }
    }

    [[nodiscard]] const BackupBytes& bytes() const { return tar_; }
    /// Makes the sums of all headers right, and then SHA256SUMS, if it has room.
    [[nodiscard]] BackupBytes sealed()
    {
        const auto all = headers();
        for (const std::size_t at : all) {
            seal_header(at);
        }
        if (!all.empty() && text(all.front(), 100) == "SHA256SUMS") {
            const std::string sums = sums_of({all.begin() + 1, all.end()});
            const std::size_t room = content(all.front()).size();
            put(all.front() + size, std::string_view{sums}.substr(0, room));
        }
        return tar_;
    }

private:
    [[nodiscard]] bool is_zero(std::size_t at) const
    {
        return std::ranges::all_of(std::span{tar_}.subspan(at, size),
                                   [](std::byte each) { return each == std::byte{0}; });
    }
    void seal_header(std::size_t at)
    {
        put(at + 148, "        ");
        unsigned sum = 0;
        for (std::size_t i = 0; i < size; ++i) {
            sum += std::to_integer<unsigned>(tar_[at + i]);
        }
        std::string digits(6, '0');
        for (std::size_t i = digits.size(); i-- > 0; sum >>= 3U) {
            digits[i] = static_cast<char>('0' + (sum & 7U));
        }
        put(at + 148, digits + '\0' + ' ');
    }
    [[nodiscard]] std::string sums_of(const std::vector<std::size_t>& files) const
    {
        std::string sums;
        std::string path;
        for (const std::size_t at : files) {
            const auto bytes = content(at);
            if (tar_[at + 156] == std::byte{'x'}) {
                const std::string record{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
                const std::size_t begin = record.find('=') + 1; // 0 without one
                path = begin > 0 ? record.substr(begin, record.size() - begin - 1) : "";
                continue;
            }
            for (const std::byte byte : crypto::sha256(bytes)) {
                sums += "0123456789abcdef"[std::to_integer<std::size_t>(byte >> 4U)];
                sums += "0123456789abcdef"[std::to_integer<std::size_t>(byte & std::byte{15})];
            }
            const std::string prefix = text(at + 345, 155);
            const std::string name = (prefix.empty() ? "" : prefix + "/") + text(at, 100);
            sums += "  " + (path.empty() ? name : path) + '\n';
            path.clear();
        }
        return sums;
    }

    BackupBytes tar_;
};

} // namespace busbar::test
