#include "message_fields.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <type_traits>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/harness/text.hpp>
#include <busbar/types/fields.hpp>
#include <busbar/types/registry.hpp>

#include "dissector.hpp"

namespace busbar::harness::detail {

namespace {

constexpr std::size_t max_elements = 1'000;
constexpr std::size_t max_fields = 100'000;
constexpr std::size_t max_summary = 160;

/// Returns a sign of all of a value, since its text may be abridged: " #0123456789abcdef".
template <typename T>
std::string sign_of(const T& value)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, value);
    std::uint64_t hash = 14'695'981'039'346'656'037U; // FNV-1a
    for (const std::byte byte : sink.take(writer.written())) {
        hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 1'099'511'628'211U;
    }
    std::array<char, 17> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16).ptr;
    return " #" + std::string{digits.data(), end};
}

/// Writes down the fields of a structure, one after the other.
class Collector {
public:
    Collector(std::vector<MessageField>& fields, DataValues values)
        : fields_{&fields}, values_{values}
    {
    }

    template <typename T>
    void operator()(const char* name, const T& value)
    {
        const std::size_t size = path_.size();
        path_ += (path_.empty() ? "" : ".") + spelled(name);
        add(value);
        path_.resize(size);
    }
    template <typename T>
    void add(const T& value)
    {
        if constexpr (std::is_enum_v<T>) {
            leaf(std::to_string(static_cast<long long>(value)));
        } else if constexpr (std::is_same_v<T, DataValue>) {
            add_data_value(value);
        } else if constexpr (std::is_same_v<T, StatusCode>) {
            leaf(text_of(value));
        } else if constexpr (std::is_same_v<T, Variant>) {
            leaf_of(value, text_of(value));
        } else if constexpr (std::is_same_v<T, ExtensionObject>) {
            add_object(value);
        } else if constexpr (std::is_same_v<T, DiagnosticInfo>) {
            if (value != T{}) {
                leaf("a DiagnosticInfo");
            }
        } else if constexpr (requires { visit_fields(value, *this); }) {
            visit_fields(value, *this);
        } else if constexpr (requires { Variant{value}; }) {
            const std::string text = text_of(Variant{value});
            leaf_of(value, text.substr(text.find(' ') + 1));
        } else {
            leaf("...");
        }
    }
    template <typename T>
    void add(const Array<T>& values)
    {
        const std::size_t size = path_.size();
        for (std::size_t i = 0; i < std::min(values.size(), max_elements); ++i) {
            path_ += "[" + std::to_string(i) + "]";
            add(values[i]);
            path_.resize(size);
        }
        if (values.empty() || values.size() > max_elements) {
            leaf(
                std::to_string(values.size()) + " elements" +
                (values.empty() || values_ == DataValues::Whole ? std::string{} : sign_of(values)));
        }
    }

private:
    void add_object(const ExtensionObject& object);
    void add_data_value(const DataValue& value);
    void leaf(std::string text)
    {
        if (fields_->size() < max_fields) {
            fields_->push_back({path_, std::move(text)});
        } else if (fields_->size() == max_fields) {
            fields_->push_back({"...", "there are more fields"});
        }
    }
    /// The text may lack a part of the value, which its sign then stands for.
    template <typename T>
    void leaf_of(const T& value, std::string text)
    {
        constexpr std::size_t most = 256; // bytes of a text that are shown
        const bool is_abridged = text.size() >= most || text.find("...") != std::string::npos ||
                                 text.ends_with(" bytes") || text.starts_with("LocalizedText");
        if (is_abridged && values_ == DataValues::InParts) {
            text += sign_of(value);
        }
        leaf(std::move(text));
    }

    std::vector<MessageField>* fields_;
    DataValues values_;
    std::string path_;
};

using Collect = void (*)(Collector& collector, const void* object);

/// Returns the function that writes down each structure, by its type.
const std::map<const StructureType*, Collect>& collectors()
{
    static const auto made = [] {
        std::map<const StructureType*, Collect> table;
        visit_structures([&]<typename T>(std::type_identity<T>) {
            if constexpr (requires { T::type; }) {
                table[&T::type] = [](Collector& collector, const void* object) {
                    visit_fields(*static_cast<const T*>(object), collector);
                };
            }
        });
        return table;
    }();
    return made;
}

void Collector::add_object(const ExtensionObject& object)
{
    const auto found = collectors().find(object.type());
    if (object.type() == nullptr || found == collectors().end()) {
        if (!object.is_null()) {
            leaf("a structure " + to_string(object.encoding_id()));
        }
        return;
    }
    found->second(*this, object.object());
}

void Collector::add_data_value(const DataValue& value)
{
    if (values_ == DataValues::Whole) {
        leaf(text_of(value));
        return;
    }
    const DataValue nothing;
    const auto part = [&](const char* name, const auto& own, const auto& default_value) {
        if (own != default_value) {
            (*this)(name, own);
        }
    };
    part("Value", value.value, nothing.value);
    part("Status", value.status, nothing.status);
    part("SourceTimestamp", value.source_timestamp, nothing.source_timestamp);
    part("ServerTimestamp", value.server_timestamp, nothing.server_timestamp);
}

/// Whether the field belongs in a line about its message.
bool is_telling(const MessageField& field)
{
    static constexpr std::array names{
        std::string_view{"nodeId"},          std::string_view{"objectId"},
        std::string_view{"methodId"},        std::string_view{"startingNode"},
        std::string_view{"value"},           std::string_view{"results"},
        std::string_view{"statusCode"},      std::string_view{"subscriptionId"},
        std::string_view{"subscriptionIds"}, std::string_view{"monitoredItemId"},
        std::string_view{"sequenceNumber"},  std::string_view{"inputArguments"},
        std::string_view{"outputArguments"}, std::string_view{"endpointUrl"},
        std::string_view{"sessionName"},     std::string_view{"eventFields"}};
    if (field.name() == "serviceResult") {
        return field.text != "Good";
    }
    if (field.path.starts_with("requestHeader") || field.path.starts_with("responseHeader") ||
        field.text == "0 elements") {
        return false;
    }
    return std::find(names.begin(), names.end(), field.name()) != names.end();
}

} // namespace

std::string spelled(std::string_view name)
{
    std::string text{name};
    if (!text.empty() && text[0] >= 'A' && text[0] <= 'Z') {
        text[0] = static_cast<char>(text[0] + 32);
    }
    return text;
}

std::string_view MessageField::name() const
{
    std::string_view last{path};
    last.remove_prefix(last.rfind('.') + 1); // npos + 1 is 0
    return last.substr(0, last.find('['));
}

std::optional<MessageFields> read_message(std::span<const std::byte> body, DataValues values)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    binary::Reader reader{body, binary::Strings::Own, &types};
    NodeId id;
    decode(reader, id);
    const StructureType* const type = reader.ok() ? types.find(id) : nullptr;
    const auto found = collectors().find(type);
    if (type == nullptr || found == collectors().end()) {
        return std::nullopt;
    }
    // The object is in an ExtensionObject, which destroys it.
    const ExtensionObject object = ExtensionObject::adopt(*type, type->create(), id);
    type->decode(reader, const_cast<void*>(object.object()));
    if (!reader.ok()) {
        return std::nullopt;
    }
    MessageFields message{type->name, {}};
    Collector collector{message.fields, values};
    found->second(collector, object.object());
    return message;
}

std::string summary_of(const MessageFields& message)
{
    std::string text{message.name};
    std::size_t left_out = 0;
    for (const MessageField& field : message.fields) {
        if (!is_telling(field)) {
            continue;
        }
        const bool is_number = (field.name().ends_with("Id") || field.name().ends_with("Ids")) &&
                               field.text.find('=') == std::string::npos;
        const std::string shown =
            (is_number || field.name() == "sequenceNumber" ? std::string{field.name()} + " " : "") +
            field.text;
        if (text.size() + shown.size() > max_summary) {
            ++left_out;
        } else {
            text += " " + shown;
        }
    }
    return left_out == 0 ? text : text + " ... (" + std::to_string(left_out) + " more)";
}

} // namespace busbar::harness::detail
