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

#include "controller/life/checksum.hpp"

namespace busbar::controller::detail {

namespace {

using busbar::detail::Json;
using busbar::detail::JsonWriter;

constexpr std::string_view backup_magic = "BUSBARBK";
constexpr std::uint32_t backup_version = 1;
constexpr std::size_t header_size = backup_magic.size() + 2 * sizeof(std::uint32_t);
constexpr std::size_t max_manifest_size = 4U << 20U;

struct GroupName {
    MemoryGroup group;
    std::string_view name;
};
/// Those that may be in a backup.
constexpr std::array group_names{GroupName{MemoryGroup::ServerSettings, "settings"},
                                 GroupName{MemoryGroup::RetainedValues, "values"},
                                 GroupName{MemoryGroup::SecurityProfile, "security"},
                                 GroupName{MemoryGroup::EventLog, "events"}};

// Writing.

void append_number(std::vector<std::byte>& to, std::uint32_t number)
{
    for (unsigned shift = 0; shift < 32; shift += 8) {
        to.push_back(static_cast<std::byte>(number >> shift & 0xFFU));
    }
}

void append_text(std::vector<std::byte>& to, std::string_view text)
{
    const auto bytes = std::as_bytes(std::span{text});
    to.insert(to.end(), bytes.begin(), bytes.end());
}

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

std::string manifest_of(const SavedMemory& memory)
{
    JsonWriter json;
    json.begin_object();
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

// Reading.

Unexpected<Problem> no_backup(std::string text)
{
    return misconfigured("backup", std::move(text));
}

std::uint32_t number_at(std::span<const std::byte> bytes, std::size_t at)
{
    std::uint32_t number = 0;
    for (unsigned i = 0; i < 4; ++i) {
        number |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
    }
    return number;
}

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

/// Takes the manifest's files from the bytes behind it.
class BackupReader {
public:
    BackupReader(std::span<const std::byte> content, const MemoryLimits& limits)
        : content_{content}, limits_{limits}
    {
    }

    [[nodiscard]] Configured<SavedMemory> read(const Json& manifest);

private:
    [[nodiscard]] Configured<void> read_item(const Json& json, SavedMemory& memory);
    [[nodiscard]] Configured<void> read_file(const Json& json, SavedItem& item);

    std::span<const std::byte> content_;
    const MemoryLimits& limits_;
    std::unordered_set<std::string> item_names_;
    std::unordered_set<std::string> file_names_;
    std::size_t names_size_{0};
};

Configured<SavedMemory> BackupReader::read(const Json& manifest)
{
    const std::string* const controller = text_in(manifest, "controller");
    const Json* const opc_ua = manifest.find("opc_ua");
    const Json* const items = list_in(manifest, "items");
    if (controller == nullptr || opc_ua == nullptr || items == nullptr ||
        (opc_ua->kind != Json::Kind::True && opc_ua->kind != Json::Kind::False)) {
        return no_backup("found a manifest without controller, opc_ua or items");
    }
    SavedMemory memory;
    memory.label.controller = *controller;
    memory.has_opc_ua = opc_ua->kind == Json::Kind::True;
    if (!memory.has_opc_ua && !items->items.empty()) {
        return no_backup("found data of an OPC UA server in the backup of a controller without");
    }
    for (const Json& item : items->items) {
        if (auto read = read_item(item, memory); !read) {
            return Unexpected{std::move(read.error())};
        }
    }
    if (!content_.empty()) {
        return no_backup("found " + std::to_string(content_.size()) +
                         " bytes more than the manifest names");
    }
    return memory;
}

Configured<void> BackupReader::read_item(const Json& json, SavedMemory& memory)
{
    const std::string* const name = text_in(json, "name");
    const std::string* const group = text_in(json, "group");
    const Json* const files = list_in(json, "files");
    if (name == nullptr || group == nullptr || files == nullptr) {
        return no_backup("found an item without name, group or files");
    }
    const auto* const known =
        std::find_if(group_names.begin(), group_names.end(),
                     [&](const GroupName& each) { return each.name == *group; });
    if (known == group_names.end() || !item_names_.insert(*name).second) {
        return no_backup("found " + printable(*name) + " of group " + printable(*group) +
                         ", expected each item once, of group settings, security or events");
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

Configured<void> BackupReader::read_file(const Json& json, SavedItem& item)
{
    const std::string* const name = text_in(json, "name");
    const auto size = size_in(json);
    if (name == nullptr || !size || !is_storage_name(*name) || !is_saved_name(*name) ||
        !file_names_.insert(*name).second) {
        return no_backup("found a file without size or with a name that is none or is there "
                         "twice, in " +
                         printable(item.name));
    }
    names_size_ += name->size();
    if (*size > content_.size() || *size > limits_.max_file_size ||
        file_names_.size() > limits_.max_files || names_size_ > limits_.max_names_size) {
        return no_backup("found more files or bytes than the backup has or the limits allow, at " +
                         printable(*name));
    }
    const auto bytes = content_.first(*size);
    item.files.push_back({*name, {bytes.begin(), bytes.end()}});
    content_ = content_.subspan(*size);
    return {};
}

} // namespace

bool is_saved_name(const std::string& name)
{
    JsonWriter json;
    json.string(name);
    const auto read = busbar::detail::parse_json(json.document(), {.allows_nul = false});
    return read && read->text == name;
}

std::vector<std::byte> write_backup(const SavedMemory& memory)
{
    const std::string manifest = manifest_of(memory);
    std::vector<std::byte> file;
    append_text(file, backup_magic);
    append_number(file, backup_version);
    append_number(file, static_cast<std::uint32_t>(manifest.size()));
    append_text(file, manifest);
    for (const SavedItem& item : memory.items) {
        for (const SavedFile& each : item.files) {
            file.insert(file.end(), each.bytes.begin(), each.bytes.end());
        }
    }
    append_number(file, checksum(file));
    return file;
}

Configured<SavedMemory> read_backup(std::span<const std::byte> file, const MemoryLimits& limits)
{
    constexpr std::size_t sum_size = sizeof(std::uint32_t);
    const auto magic = std::as_bytes(std::span{backup_magic});
    if (file.size() > limits.max_backup_size || file.size() < header_size + sum_size ||
        !std::equal(magic.begin(), magic.end(), file.begin())) {
        return no_backup("is no backup file or too large");
    }
    const auto content = file.first(file.size() - sum_size);
    if (checksum(content) != number_at(file, content.size())) {
        return no_backup("is cut or damaged: the checksum is another one");
    }
    if (const std::uint32_t version = number_at(file, magic.size()); version != backup_version) {
        return no_backup("found version " + std::to_string(version) + ", expected " +
                         std::to_string(backup_version));
    }
    const std::size_t size = number_at(file, magic.size() + sum_size);
    if (size > max_manifest_size || size > content.size() - header_size) {
        return no_backup("found a manifest larger than the file or the limits");
    }
    const auto manifest = content.subspan(header_size, size);
    const auto json = busbar::detail::parse_json(
        {reinterpret_cast<const char*>(manifest.data()), manifest.size()},
        {.max_size = max_manifest_size, .max_depth = 8, .max_values = 65'536, .allows_nul = false});
    if (!json) {
        return no_backup("the manifest: " + printable(json.error()));
    }
    return BackupReader{content.subspan(header_size + size), limits}.read(*json);
}

} // namespace busbar::controller::detail
