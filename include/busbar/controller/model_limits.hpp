#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/api.hpp>

namespace busbar::controller {

/// Limits of the size of information models and their mapping (SH-082679, 2.1). The
/// default keeps hostile files from exhausting memory, and exceeds what plants have.
struct ModelLimits {
    // Limits of an import, which refuses more.

    std::size_t max_files{1'000};
    /// Bytes of all files together.
    std::uint64_t max_file_size{512U << 20U};
    /// Without namespace 0.
    std::size_t max_namespaces{1'000};
    /// Characters of a NamespaceUri.
    std::size_t max_uri_length{4'096};
    /// Without those that are built in.
    std::size_t max_nodes{4'000'000};
    /// Nested levels of `<Element>` and `<Field>` within one mapping.
    std::size_t max_part_levels{64};
    /// Parts of all mappings of a file, with and without labels.
    std::size_t max_parts{8'000'000};

    // Limits that a check reports.

    /// Mappable Variables below Objects.
    std::size_t max_variables{4'000'000};
    /// The size of their values in words of 16 bits.
    std::uint64_t max_variable_words{std::uint64_t{1} << 32U};
    /// Levels of nodes below Objects.
    std::size_t max_node_levels{100};
    /// Nested structures, including the outermost.
    std::size_t max_structure_levels{100};
    /// Elements of an array that is mapped element by element: the product of its dimensions.
    std::uint32_t max_elements{1'000'000};
    /// Mapped labels; a label that is mapped twice counts twice.
    std::size_t max_labels{4'000'000};
    /// Characters of a label's name.
    std::size_t max_label_length{800};
    /// Characters of all label names together.
    std::uint64_t max_total_label_length{std::uint64_t{1} << 31U};
    /// If false, a check warns of instances of the types of namespace 0 that the product names.
    bool supports_all_types{true};

    // Limits of data from clients.

    std::uint32_t max_array_length{1'000'000};
    /// In bytes.
    std::uint32_t max_string_length{1U << 20U};
    std::uint32_t max_byte_string_length{16U << 20U};

    friend bool operator==(const ModelLimits&, const ModelLimits&) = default;
};

/// RD81OPC96 (SH-082679, 2.1): 10 files of 20 MB together, 10 namespaces of 134
/// characters, 50,000 nodes on 20 levels, 25,000 Variables of 2,048K words, structures on 20
/// levels, arrays of 10,240 elements, 25,000 labels of 800 and together 2,500,000 characters; from
/// clients arrays of 25,000 elements, strings of 1 KB and byte strings of 10 KB; 21 types without
/// instances.
[[nodiscard]] BUSBAR_API ModelLimits rd81opc96_model();

/// The use of its limits by a project, as the status bar shows it (SH-082679, 4.2).
struct ModelCounters {
    std::size_t labels{0};
    std::uint64_t label_length{0};
    std::uint64_t variable_words{0};
    std::size_t variables{0};
    std::uint64_t file_size{0};

    friend bool operator==(const ModelCounters&, const ModelCounters&) = default;
};

/// The state of an item of the status bar.
enum class LimitState : std::uint8_t {
    Kept,
    DetailExceeded, // a value in the item's tooltip exceeds its limit (orange)
    Exceeded,       // the item's value exceeds its limit (red)
};

/// The three items of the status bar.
struct StatusBar {
    LimitState mapping_count{LimitState::Kept};
    LimitState variable_size{LimitState::Kept};
    LimitState file_size{LimitState::Kept};

    friend bool operator==(const StatusBar&, const StatusBar&) = default;
};

/// Compares what is counted with the limits.
[[nodiscard]] BUSBAR_API StatusBar status_bar(const ModelCounters& counters,
                                              const ModelLimits& limits);

/// Returns the words in units of 1,024, rounded up, as the status bar shows them.
[[nodiscard]] constexpr std::uint64_t kilo_words(std::uint64_t words)
{
    return words / 1024U + (words % 1024U == 0 ? 0U : 1U);
}

} // namespace busbar::controller
