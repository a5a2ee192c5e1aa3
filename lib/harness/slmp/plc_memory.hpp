#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/backend/slmp_message.hpp>

namespace busbar::harness::detail {

/// The devices of a simulated PLC.
class PlcMemory {
public:
    enum class Access : std::uint8_t { Done, UnknownDevice, OutOfRange, NotInBits };

    bool add(std::string_view kind, std::uint32_t count);
    /// Reads words from a device on; of bits, 16 to a word.
    [[nodiscard]] Access read_words(const backend::SlmpDevice& device,
                                    std::span<std::uint16_t> words) const;
    [[nodiscard]] Access write_words(const backend::SlmpDevice& device,
                                     std::span<const std::uint16_t> words);
    /// Reads bits, each a word.
    [[nodiscard]] Access read_bits(const backend::SlmpDevice& device,
                                   std::span<std::uint16_t> bits) const;
    [[nodiscard]] Access write_bits(const backend::SlmpDevice& device,
                                    std::span<const std::uint16_t> bits);
    /// The answer to requests for a device from now on.
    void refuse(const backend::SlmpDevice& device, std::uint16_t end_code)
    {
        refused_.insert_or_assign(device, end_code);
    }
    void refuse_none() { refused_.clear(); }
    /// Returns the end code of the first refused device of a request of this size; 0 if it has
    /// none. `size` counts words or bits.
    [[nodiscard]] std::uint16_t refusal(const backend::SlmpDevice& device, std::size_t size,
                                        bool is_in_bits) const;
    /// What a write of this size would answer.
    [[nodiscard]] Access check(const backend::SlmpDevice& device, std::size_t size,
                               bool is_in_bits) const;

private:
    struct Area {
        bool has_bits{false};
        std::uint32_t words_per_number{1};
        /// A word each, or a bit.
        std::vector<std::uint16_t> values{};
    };
    /// Code, direct memory and extension, which tell areas apart.
    [[nodiscard]] static backend::SlmpDevice key_of(const backend::SlmpDevice& device);

    std::map<backend::SlmpDevice, Area> areas_;
    std::map<backend::SlmpDevice, std::uint16_t> refused_;
};

/// The labels of a simulated PLC.
class PlcLabels {
public:
    struct Label {
        std::uint8_t type{0};
        std::size_t element_size{1};
        std::vector<std::byte> value{};
    };
    /// A label, and the element of it that a name means.
    struct Place {
        Label* label{nullptr};
        std::size_t offset{0};
    };

    void add(std::string_view name, Label label);
    void clear() { labels_.clear(); }
    [[nodiscard]] const Label* find(std::string_view name) const;
    /// Serves a command with labels; returns an end code.
    [[nodiscard]] std::uint16_t serve(const backend::SlmpOperation& operation,
                                      backend::SlmpAnswer& answer);

private:
    [[nodiscard]] std::optional<Place> resolve(std::string_view name,
                                               std::span<const std::string> abbreviations);
    [[nodiscard]] static std::uint16_t read(const Place& place, const backend::SlmpLabel& label,
                                            bool is_array, backend::SlmpAnswer& answer);
    [[nodiscard]] static std::uint16_t write(const Place& place, const backend::SlmpLabel& label,
                                             bool is_array);

    /// By name in lower case.
    std::map<std::string, Label, std::less<>> labels_;
};

} // namespace busbar::harness::detail
