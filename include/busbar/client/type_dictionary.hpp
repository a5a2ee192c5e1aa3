#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/refusal.hpp>

/// Type dictionaries, with which servers before OPC UA 1.04 describe their structures (Part 5,
/// Annexes C and D of 1.05; Annexes E and D of 1.04).
namespace busbar::client {

/// Limits of a dictionary, which may come from a hostile server.
struct DictionaryLimits {
    /// Bytes of the XML.
    std::size_t max_bytes{2'000'000};
    std::size_t max_types{5'000};
    /// Fields of one structure, including bits and lengths.
    std::size_t max_fields{1'000};
    /// Values of one enumeration.
    std::size_t max_values{10'000};
    /// Bytes of a name.
    std::size_t max_name_length{512};
};

/// The name of a type and the namespace that it is defined in.
struct DictionaryName {
    std::string namespace_uri;
    std::string name;

    friend auto operator<=>(const DictionaryName&, const DictionaryName&) = default;
};

/// A field of a structure or a union.
struct DictionaryField {
    std::string name;
    DictionaryName type;
    bool is_array{false};
    bool is_optional{false};
};

/// A type in the terms of OPC UA: lengths, switches and bits of the dictionary have become arrays,
/// unions and optional fields (Part 6, 5.2.5 to 5.2.8).
struct DictionaryType {
    /// The kind of type that it becomes in OPC UA.
    enum class Kind : std::uint8_t { Structure, Union, Enumeration, Number };

    std::string name;
    Kind kind{Kind::Structure};
    std::vector<DictionaryField> fields;
    /// For a Structure: values begin with an EncodingMask.
    bool has_mask{false};
    /// The values of an Enumeration.
    std::vector<std::pair<std::int64_t, std::string>> values;
    /// The size of a Number, which is unsigned: 8, 16, 32 or 64.
    unsigned bits{0};
    /// The reason why values cannot be decoded by the description; empty if they can.
    std::string reason;
};

/// The types of one dictionary, in its order.
struct TypeDictionary {
    std::string namespace_uri;
    std::vector<DictionaryType> types;
};

/// Reads a dictionary, an XML document. Refuses a document that is not a dictionary, has a DOCTYPE
/// or exceeds a limit; a type that OPC UA Binary cannot have is listed with its reason.
using DictionaryParser = Checked<TypeDictionary> (*)(std::span<const std::byte> xml,
                                                     const DictionaryLimits& limits);

/// The DictionaryParser of the target busbar::dictionary, which brings pugixml with it.
[[nodiscard]] BUSBAR_API Checked<TypeDictionary>
parse_type_dictionary(std::span<const std::byte> xml, const DictionaryLimits& limits = {});

} // namespace busbar::client
