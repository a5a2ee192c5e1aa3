#include "backup_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <unordered_set>
#include <utility>

#include <busbar/core/text.hpp>
#include <core/json.hpp>
#include <core/json_writer.hpp>

namespace busbar::controller::detail {

namespace {

using busbar::detail::Json;
using busbar::detail::JsonWriter;

struct GroupName {
    MemoryGroup group;
    std::string_view name;
};
/// Names of the groups that items of a backup belong to.
constexpr std::array group_names{GroupName{MemoryGroup::ServerSettings, "settings"},
                                 GroupName{MemoryGroup::RetainedValues, "values"},
                                 GroupName{MemoryGroup::SecurityProfile, "security"},
                                 GroupName{MemoryGroup::EventLog, "events"}};

// Writing.

void write_text(JsonWriter& json, std::string_view name, std::string_view text)
{
    json.name(name);
    json.string(text);
}

void write_item(JsonWriter& json, const SavedItem& item)
{
    const auto* const group =
        std::find_if(group_names.begin(), group_names.end(),
                     [&](const GroupName& each) { return each.group == item.group; });
    json.begin_object();
    write_text(json, "name", item.name);
    write_text(json, "group", group->name);
    json.name("files");
    json.begin_list();
    for (const SavedFile& file : item.files) {
        json.begin_object();
        write_text(json, "name", file.name);
        json.name("size");
        json.word(std::to_string(file.bytes.size()));
        json.end_object();
    }
    json.end_list();
    json.end_object();
}

// Reading.

const std::string* text_in(const Json& json, std::string_view name)
{
    const Json* const found = json.find(name);
    return found != nullptr && found->kind == Json::Kind::String ? &found->text : nullptr;
}

const Json* list_in(const Json& json, std::string_view name)
{
    const Json* const found = json.find(name);
    return found != nullptr && found->kind == Json::Kind::List ? found : nullptr;
}

std::optional<std::size_t> size_in(const Json& json)
{
    const Json* const found = json.find("size");
    if (found == nullptr || found->kind != Json::Kind::Number) {
        return std::nullopt;
    }
    const char* const end = found->text.data() + found->text.size();
    std::size_t size = 0;
    const auto read = std::from_chars(found->text.data(), end, size);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{size} : std::nullopt;
}

class ManifestReader {
public:
    ManifestReader(const MemoryLimits& limits, TakeFile take) : limits_{limits}, take_{take} {}

    [[nodiscard]] Configured<SavedMemory> read(const Json& manifest);

private:
    [[nodiscard]] Configured<void> read_item(const Json& json, SavedMemory& memory);
    [[nodiscard]] Configured<void> read_file(const Json& json, SavedItem& item);

    const MemoryLimits& limits_;
    TakeFile take_;
    std::unordered_set<std::string> item_names_;
    std::unordered_set<std::string> file_names_;
    std::size_t names_size_{0};
};

Configured<SavedMemory> ManifestReader::read(const Json& manifest)
{
    const std::string* const controller = text_in(manifest, "controller");
    const Json* const opc_ua = manifest.find("opc_ua");
    const Json* const items = list_in(manifest, "items");
    if (controller == nullptr || opc_ua == nullptr || items == nullptr ||
        (opc_ua->kind != Json::Kind::True && opc_ua->kind != Json::Kind::False)) {
        return wrong_backup("found a manifest without controller, opc_ua or items");
    }
    SavedMemory memory;
    memory.label.controller = *controller;
    memory.has_opc_ua = opc_ua->kind == Json::Kind::True;
    if (!memory.has_opc_ua && !items->items.empty()) {
        return wrong_backup("found data of an OPC UA server in the backup of a controller without");
    }
    for (const Json& item : items->items) {
        if (auto read = read_item(item, memory); !read) {
            return Unexpected{std::move(read.error())};
        }
    }
    return memory;
}

Configured<void> ManifestReader::read_item(const Json& json, SavedMemory& memory)
{
    const std::string* const name = text_in(json, "name");
    const std::string* const group = text_in(json, "group");
    const Json* const files = list_in(json, "files");
    if (name == nullptr || group == nullptr || files == nullptr) {
        return wrong_backup("found an item without name, group or files");
    }
    const auto* const known =
        std::find_if(group_names.begin(), group_names.end(),
                     [&](const GroupName& each) { return each.name == *group; });
    if (known == group_names.end() || !item_names_.insert(*name).second) {
        return wrong_backup("found " + printable(*name) + " of group " + printable(*group) +
                            ", expected each item once, of group settings, values, security or "
                            "events");
    }
    SavedItem item{*name, known->group, {}};
    for (const Json& file : files->items) {
        if (auto read = read_file(file, item); !read) {
            return read;
        }
    }
    memory.items.push_back(std::move(item));
    return {};
}

Configured<void> ManifestReader::read_file(const Json& json, SavedItem& item)
{
    const std::string* const name = text_in(json, "name");
    const auto size = size_in(json);
    if (name == nullptr || !size || !is_storage_name(*name) || !is_saved_name(*name) ||
        !file_names_.insert(*name).second) {
        return wrong_backup("found a file without a size, without a valid name or with the name of "
                            "another one, in " +
                            printable(item.name));
    }
    names_size_ += name->size();
    if (*size > limits_.max_file_size || file_names_.size() > limits_.max_files ||
        names_size_ > limits_.max_names_size) {
        return wrong_backup("found more files or bytes than the limits allow, at " +
                            printable(*name));
    }
    const auto bytes = take_(*name, *size);
    if (!bytes) {
        return Unexpected{bytes.error()};
    }
    item.files.push_back({*name, {bytes->begin(), bytes->end()}});
    return {};
}

/// The version comes first: what else there is depends on it.
Configured<void> check_version(const Json& manifest)
{
    const Json* const version = manifest.find("version");
    if (version == nullptr || version->kind != Json::Kind::Number) {
        return wrong_backup("found a manifest without version");
    }
    if (version->text != backup_version) {
        return wrong_backup("found version " + printable(version->text) + ", expected " +
                            std::string{backup_version});
    }
    return {};
}

} // namespace

std::string manifest_of(const SavedMemory& memory)
{
    JsonWriter json;
    json.begin_object();
    json.name("version");
    json.word(backup_version);
    write_text(json, "controller", memory.label.controller);
    write_text(json, "created", to_string(memory.label.time));
    json.name("opc_ua");
    json.word(memory.has_opc_ua ? "true" : "false");
    json.name("items");
    json.begin_list();
    for (const SavedItem& item : memory.items) {
        write_item(json, item);
    }
    json.end_list();
    json.end_object();
    return json.take();
}

Configured<SavedMemory> read_manifest(std::span<const std::byte> manifest, ManifestForm form,
                                      const MemoryLimits& limits, TakeFile take)
{
    const auto json = busbar::detail::parse_json(
        {reinterpret_cast<const char*>(manifest.data()), manifest.size()},
        {.max_size = max_manifest_size, .max_depth = 8, .max_values = 65'536, .allows_nul = false});
    if (!json) {
        return wrong_backup("the manifest: " + printable(json.error()));
    }
    if (form == ManifestForm::WithVersion) {
        if (auto checked = check_version(*json); !checked) {
            return Unexpected{std::move(checked.error())};
        }
    }
    return ManifestReader{limits, take}.read(*json);
}

Unexpected<Problem> wrong_backup(std::string text)
{
    return misconfigured("backup", std::move(text));
}

bool is_saved_name(const std::string& name)
{
    JsonWriter json;
    json.string(name);
    const auto read = busbar::detail::parse_json(json.document(), {.allows_nul = false});
    return read && read->text == name;
}

} // namespace busbar::controller::detail
