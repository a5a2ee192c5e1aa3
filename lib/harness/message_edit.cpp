#include "message_fields.hpp"

#include <charconv>
#include <map>
#include <type_traits>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/client/value_text.hpp>
#include <busbar/types/fields.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::harness::detail {

namespace {

/// Goes down a path and sets what is at its end.
class Editor {
public:
    Editor(std::string_view path, std::string_view text) : path_{path}, text_{text} {}

    /// For visit_fields.
    template <typename T>
    void operator()(const char* name, T& value)
    {
        const std::string own = spelled(name);
        const std::string_view next = path_.substr(done_, path_.find_first_of(".[", done_) - done_);
        if (is_found_ || next != own) {
            return;
        }
        is_found_ = true;
        done_ += own.size();
        set(value);
    }
    template <typename T>
    void set_fields(T& structure)
    {
        is_found_ = false;
        const std::size_t begin = done_;
        visit_fields(structure, *this);
        if (!is_found_) {
            fail("there is no field \"" + std::string{path_.substr(begin)} + "\"");
        }
    }
    [[nodiscard]] const std::string& flaw() const { return flaw_; }

private:
    template <typename T>
    void set(T& value)
    {
        if constexpr (requires {
                          value[0];
                          value.size();
                      } &&
                      !BuiltIn<T>) {
            set_element(value);
        } else if constexpr (std::is_same_v<T, DataValue>) {
            set_data_value(value);
        } else if constexpr (std::is_same_v<T, ExtensionObject>) {
            set_object(value);
        } else if constexpr (requires { visit_fields(value, *this); }) {
            if (step()) {
                set_fields(value);
            }
        } else if constexpr (std::is_enum_v<T>) {
            std::underlying_type_t<T> number{};
            assign(number);
            value = static_cast<T>(number);
        } else if constexpr (BuiltIn<T>) {
            assign(value);
        } else {
            fail("a field of this type cannot be set");
        }
    }
    template <typename T>
    void assign(T& value)
    {
        if (done_ != path_.size()) {
            fail("there is nothing within \"" + std::string{path_.substr(0, done_)} + "\"");
            return;
        }
        client::ValueType type;
        type.built_in = built_in_type_of<T>;
        auto read = client::parse_value(text_, type);
        if (!read) {
            fail(read.error().message);
        } else if constexpr (std::is_same_v<T, Variant>) {
            value = *std::move(read);
        } else if (const T* const found = read->template get_if<T>()) {
            value = *found;
        } else {
            fail("a field of this type cannot be set");
        }
    }
    template <typename T>
    void set_element(T& values)
    {
        std::size_t index = 0;
        const char* const end = path_.data() + path_.size();
        const auto number = done_ < path_.size() && path_[done_] == '['
                                ? std::from_chars(path_.data() + done_ + 1, end, index)
                                : std::from_chars_result{end, std::errc::invalid_argument};
        if (number.ec != std::errc{} || number.ptr == end || *number.ptr != ']') {
            fail("expected an index in brackets after \"" + std::string{path_.substr(0, done_)} +
                 "\"");
        } else if (index >= values.size()) {
            fail("there are only " + std::to_string(values.size()) + " elements");
        } else {
            done_ = static_cast<std::size_t>(number.ptr - path_.data()) + 1;
            set(values[index]);
        }
    }
    void set_data_value(DataValue& value)
    {
        if (!step()) {
            return;
        }
        is_found_ = false;
        const std::size_t begin = done_;
        (*this)("Value", value.value);
        (*this)("Status", value.status);
        (*this)("SourceTimestamp", value.source_timestamp);
        (*this)("ServerTimestamp", value.server_timestamp);
        if (!is_found_) {
            fail("there is no field \"" + std::string{path_.substr(begin)} + "\" in a DataValue");
        }
    }
    void set_object(ExtensionObject& object);
    /// Steps over the point that leads into a structure.
    [[nodiscard]] bool step()
    {
        if (done_ < path_.size() && path_[done_] == '.') {
            ++done_;
            return true;
        }
        fail("expected a field of \"" + std::string{path_.substr(0, done_)} + "\"");
        return false;
    }
    /// Keeps what went wrong first: farthest within the path, it says most.
    void fail(std::string flaw)
    {
        if (flaw_.empty()) {
            flaw_ = std::move(flaw);
        }
    }

    std::string_view path_;
    std::string_view text_;
    std::size_t done_{0};
    bool is_found_{false};
    std::string flaw_;
};

using EditObject = void (*)(Editor& editor, void* object);

/// Returns the function that edits each structure, by its type.
const std::map<const StructureType*, EditObject>& editors()
{
    static const auto made = [] {
        std::map<const StructureType*, EditObject> table;
        visit_structures([&]<typename T>(std::type_identity<T>) {
            if constexpr (requires { T::type; }) {
                table[&T::type] = [](Editor& editor, void* object) {
                    editor.set_fields(*static_cast<T*>(object));
                };
            }
        });
        return table;
    }();
    return made;
}

void Editor::set_object(ExtensionObject& object)
{
    const auto found = editors().find(object.type());
    if (object.type() == nullptr || found == editors().end()) {
        fail("the structure of an ExtensionObject is not known");
    } else if (step()) {
        // The message's only owner is the one that edits it.
        found->second(*this, const_cast<void*>(object.object()));
    }
}

} // namespace

std::string edit_message(std::vector<std::byte>& body, std::string_view path, std::string_view text)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    binary::Reader reader{body, binary::Strings::Own, &types};
    NodeId id;
    decode(reader, id);
    const StructureType* const type = reader.ok() ? types.find(id) : nullptr;
    const auto found = editors().find(type);
    if (type == nullptr || found == editors().end()) {
        return "its structure is not known";
    }
    // The object is in an ExtensionObject, which destroys it.
    const ExtensionObject object = ExtensionObject::adopt(*type, type->create(), id);
    void* const fields = const_cast<void*>(object.object());
    type->decode(reader, fields);
    if (!reader.ok()) {
        return "it cannot be decoded";
    }
    Editor editor{path, text};
    found->second(editor, fields);
    if (!editor.flaw().empty()) {
        return editor.flaw();
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, id);
    type->encode(writer, fields);
    if (!writer.ok()) {
        return "it cannot be encoded any more";
    }
    body = sink.take(writer.written());
    return {};
}

} // namespace busbar::harness::detail
