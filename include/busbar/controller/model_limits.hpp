#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/api.hpp>

namespace busbar::controller {

/// How large information models and their mapping may be (seed 001, 2.1). The default keeps
/// hostile files from taking all memory, and is beyond what plants have.
struct ModelLimits {
    // What an import refuses.

    std::size_t max_files{1'000};
    /// Bytes of all files together.
    std::uint64_t max_file_size{512U << 20U};
    /// Without namespace 0.
    std::size_t max_namespaces{1'000};
    /// Characters of a NamespaceUri.
    std::size_t max_uri_length{4'096};
    /// Without those that are built in.
    std::size_t max_nodes{4'000'000};
    /// Levels of <Element> and <Field> within one mapping.
    std::size_t max_part_levels{64};
    /// Parts of all mappings of a file, with and without labels.
    std::size_t max_parts{8'000'000};

    // What a check reports.

    /// Variables below Objects that could be mapped.
    std::size_t max_variables{4'000'000};
    /// Of their values in words of 16 bits.
    std::uint64_t max_variable_words{std::uint64_t{1} << 32U};
    /// Of nodes below Objects.
    std::size_t max_node_levels{100};
    /// Of structures within one another, the outermost included.
    std::size_t max_structure_levels{100};
    /// Of an array that is mapped element by element, the product of its dimensions.
    std::uint32_t max_elements{1'000'000};
    /// Labels that are mapped; one that is mapped twice counts twice.
    std::size_t max_labels{4'000'000};
    /// Characters of a label's name.
    std::size_t max_label_length{800};
    /// Characters of all of them.
    std::uint64_t max_total_label_length{std::uint64_t{1} << 31U};
    /// Without it a check warns of instances of the types of namespace 0 that the product names.
    bool supports_all_types{true};

    // What clients may send.

    std::uint32_t max_array_length{1'000'000};
    /// Bytes.
    std::uint32_t max_string_length{1U << 20U};
    std::uint32_t max_byte_string_length{16U << 20U};

    friend bool operator==(const ModelLimits&, const ModelLimits&) = default;
};

/// RD81OPC96 (seed 001, 2.1): 10 files of 20 MB together, 10 namespaces of 134 characters, 50,000
/// nodes on 20 levels, 25,000 Variables of 2,048K words, structures on 20 levels, arrays of 10,240
/// elements, 25,000 labels of 800 and together 2,500,000 characters; from clients arrays of 25,000
/// elements, strings of 1 KB and byte strings of 10 KB; 21 types without instances.
[[nodiscard]] BUSBAR_API ModelLimits rd81opc96_model();

/// How much of its limits a project takes: what the status bar shows (seed 001, 4.2).
struct ModelCounters {
    std::size_t labels{0};
    std::uint64_t label_length{0};
    std::uint64_t variable_words{0};
    std::size_t variables{0};
    std::uint64_t file_size{0};

    friend bool operator==(const ModelCounters&, const ModelCounters&) = default;
};

/// How an item of the status bar stands.
enum class LimitState : std::uint8_t {
    Kept,
    DetailExceeded, // what only the item's tooltip shows is too much (orange)
    Exceeded,       // what the item shows is too much (red)
};

/// The three items of the status bar.
struct StatusBar {
    LimitState mapping_count{LimitState::Kept};
    LimitState variable_size{LimitState::Kept};
    LimitState file_size{LimitState::Kept};

    friend bool operator==(const StatusBar&, const StatusBar&) = default;
};

[[nodiscard]] BUSBAR_API StatusBar status_bar(const ModelCounters& counters,
                                              const ModelLimits& limits);

/// As the status bar writes it: words in units of 1,024, rounded up.
[[nodiscard]] constexpr std::uint64_t kilo_words(std::uint64_t words)
{
    return words / 1024U + (words % 1024U == 0 ? 0U : 1U);
}

} // namespace busbar::controller
