#include <busbar/client/type_dictionary.hpp>

#include <charconv>
#include <map>
#include <optional>
#include <set>

#include <pugixml.hpp>

#include <busbar/core/text.hpp>

#include "layout.hpp"

namespace busbar::client {

namespace {

using detail::RawField;

std::string_view local_name(std::string_view name)
{
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::optional<std::uint32_t> number_of(const pugi::xml_attribute& attribute)
{
    const std::string_view text = attribute.value();
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return attribute && error == std::errc{} && end == text.data() + text.size()
               ? std::optional{number}
               : std::nullopt;
}

Unexpected<Refusal> refused(StatusCode status, std::string found)
{
    return refuse({status, "type dictionary", std::move(found), "Part 5, C.2.1",
                   "Values of its types stay encoded; the server has to be corrected"});
}

/// A dictionary that is being read.
class Reader {
public:
    explicit Reader(const DictionaryLimits& limits) : limits_{limits} {}

    [[nodiscard]] Checked<TypeDictionary> read(std::span<const std::byte> xml)
    {
        if (xml.size() > limits_.max_bytes) {
            return refused(status::Bad_EncodingLimitsExceeded,
                           std::to_string(xml.size()) + " bytes, of at most " +
                               std::to_string(limits_.max_bytes));
        }
        const auto parsed =
            xml_.load_buffer(xml.data(), xml.size(), pugi::parse_default | pugi::parse_doctype);
        if (!parsed) {
            return refused(status::Bad_DecodingError,
                           std::string{"it is not well-formed XML: "} + parsed.description());
        }
        const pugi::xml_node root = xml_.document_element();
        for (const pugi::xml_node& node : xml_.children()) {
            if (node.type() == pugi::node_doctype) {
                return refused(status::Bad_DecodingError,
                               "a DOCTYPE, which a type dictionary must not have");
            }
        }
        if (local_name(root.name()) != "TypeDictionary") {
            return refused(status::Bad_DecodingError,
                           "found <" + printable(root.name(), 80) + ">, expected <TypeDictionary>");
        }
        return read_types(root);
    }

private:
    Checked<TypeDictionary> read_types(const pugi::xml_node& root)
    {
        read_prefixes(root);
        dictionary_.namespace_uri = root.attribute("TargetNamespace").value();
        is_big_endian_ = is_big_endian(root);
        for (const pugi::xml_node& xml : root.children()) {
            if (dictionary_.types.size() == limits_.max_types) {
                return refused(status::Bad_EncodingLimitsExceeded,
                               "more than " + std::to_string(limits_.max_types) + " types");
            }
            read_type(xml);
        }
        return std::move(dictionary_);
    }
    void read_prefixes(const pugi::xml_node& root)
    {
        constexpr std::string_view declaration = "xmlns";
        for (const pugi::xml_attribute& attribute : root.attributes()) {
            const std::string_view name = attribute.name();
            if (name == declaration) {
                prefixes_[""] = attribute.value();
            } else if (name.starts_with("xmlns:")) {
                prefixes_[std::string{name.substr(declaration.size() + 1)}] = attribute.value();
            }
        }
    }
    [[nodiscard]] static bool is_big_endian(const pugi::xml_node& xml)
    {
        return std::string_view{xml.attribute("DefaultByteOrder").value()} == "BigEndian";
    }

    void read_type(const pugi::xml_node& xml)
    {
        const std::string_view element = local_name(xml.name());
        const bool is_structure = element == "StructuredType";
        if (!is_structure && element != "EnumeratedType" && element != "OpaqueType") {
            return; // Documentation, Import
        }
        DictionaryType type;
        type.name = xml.attribute("Name").value();
        if (type.name.empty() || type.name.size() > limits_.max_name_length ||
            !names_.insert(type.name).second) {
            return; // nothing can refer to it
        }
        if (is_big_endian_ || is_big_endian(xml)) {
            type.reason = "OPC UA Binary is little-endian";
        } else if (is_structure) {
            read_structure(xml, type);
        } else if (element == "EnumeratedType") {
            read_enumeration(xml, type);
        } else {
            type.reason = "it is opaque";
        }
        dictionary_.types.push_back(std::move(type));
    }
    void read_structure(const pugi::xml_node& xml, DictionaryType& type)
    {
        std::vector<RawField> fields;
        for (const pugi::xml_node& child : xml.children()) {
            if (local_name(child.name()) != "Field") {
                continue;
            }
            if (fields.size() == limits_.max_fields) {
                type.reason = "it has more than " + std::to_string(limits_.max_fields) + " fields";
                return;
            }
            fields.push_back(read_field(child));
            if (fields.back().name.size() > limits_.max_name_length) {
                type.reason = "a field's name is too long";
                return;
            }
        }
        const DictionaryName base = name_of(xml.attribute("BaseType"));
        detail::lay_out(fields, base.namespace_uri == detail::ua_uri && base.name == "Union", type);
    }
    [[nodiscard]] RawField read_field(const pugi::xml_node& xml) const
    {
        RawField field;
        field.name = xml.attribute("Name").value();
        field.type = name_of(xml.attribute("TypeName"));
        if (const auto length = xml.attribute("Length")) {
            field.length = number_of(length).value_or(UINT32_MAX);
        }
        field.length_field = xml.attribute("LengthField").value();
        field.is_length_in_bytes = xml.attribute("IsLengthInBytes").as_bool();
        field.switch_field = xml.attribute("SwitchField").value();
        if (const auto value = xml.attribute("SwitchValue")) {
            field.switch_value = number_of(value).value_or(UINT32_MAX);
        }
        const std::string_view operand = xml.attribute("SwitchOperand").value();
        field.has_operand = !operand.empty() && operand != "Equals";
        field.has_terminator = !xml.attribute("Terminator").empty();
        return field;
    }
    /// An enumeration of OPC UA has 32 bits; others become numbers without names here.
    void read_enumeration(const pugi::xml_node& xml, DictionaryType& type) const
    {
        type.kind = DictionaryType::Kind::Enumeration;
        type.bits = number_of(xml.attribute("LengthInBits")).value_or(0);
        if (type.bits != 8 && type.bits != 16 && type.bits != 32 && type.bits != 64) {
            type.reason = "its LengthInBits is none of 8, 16, 32 and 64";
            return;
        }
        if (type.bits != 32 || xml.attribute("IsOptionSet").as_bool()) {
            type.kind = DictionaryType::Kind::Number;
            return;
        }
        for (const pugi::xml_node& child : xml.children()) {
            if (local_name(child.name()) != "EnumeratedValue") {
                continue;
            }
            if (type.values.size() == limits_.max_values) {
                type.reason = "it has more than " + std::to_string(limits_.max_values) + " values";
                return;
            }
            type.values.emplace_back(child.attribute("Value").as_llong(),
                                     child.attribute("Name").value());
        }
    }
    /// Returns a name with the prefix of a namespace (xs:QName).
    [[nodiscard]] DictionaryName name_of(const pugi::xml_attribute& attribute) const
    {
        const std::string_view text = attribute.value();
        const std::size_t colon = text.find(':');
        const std::string prefix{text.substr(0, colon == std::string_view::npos ? 0 : colon)};
        const auto found = prefixes_.find(prefix);
        return {found == prefixes_.end() ? std::string{} : found->second,
                std::string{local_name(text)}};
    }

    DictionaryLimits limits_;
    pugi::xml_document xml_;
    std::map<std::string, std::string> prefixes_;
    std::set<std::string> names_;
    bool is_big_endian_{false};
    TypeDictionary dictionary_;
};

} // namespace

Checked<TypeDictionary> parse_type_dictionary(std::span<const std::byte> xml,
                                              const DictionaryLimits& limits)
{
    return Reader{limits}.read(xml);
}

} // namespace busbar::client
