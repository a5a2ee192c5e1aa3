#include "remote_transfer.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <busbar/core/status_codes.hpp>

#include "remote_files.hpp"

namespace busbar::tool::admin {

namespace {

/// Protects against a server that sends without end.
constexpr std::size_t most_fetched = 256U << 20U;

} // namespace

RemoteTransfer::RemoteTransfer(Connection& connection, std::string name, const std::string& advice)
    : connection_{connection}, name_{std::move(name)}
{
    for (const NamedChild& child : objects_below(connection, standard(id::ObjectsFolder))) {
        if (child.name == name_) {
            object_ = child.id;
        }
    }
    if (object_.is_null()) {
        throw Failure{status::Bad_NotFound, name_, advice};
    }
}

std::vector<Variant> RemoteTransfer::on(const NodeId& object, const char* method,
                                        const std::vector<Variant>& inputs, std::size_t wanted)
{
    return on(object, find_method(connection_, object, method), method, inputs, wanted);
}

std::vector<Variant> RemoteTransfer::on(const NodeId& object, const NodeId& method,
                                        const char* method_name, const std::vector<Variant>& inputs,
                                        std::size_t wanted)
{
    const std::string what = name_ + ": " + method_name;
    if (method.is_null()) {
        throw Failure{status::Bad_NotFound, what, "this user may not do that"};
    }
    auto outputs = call(connection_, object, method, inputs, what);
    if (outputs.size() < wanted) {
        throw Failure{status::Bad_DecodingError, what};
    }
    return outputs;
}

std::string RemoteTransfer::fetch(const Variant& options, const Progress& progress)
{
    const auto made = on(object_, "GenerateFileForRead", {options}, 2);
    const NodeId file = made[0].value_or<NodeId>({});
    const Variant& handle = made[1];
    const NodeId read = find_method(connection_, file, "Read"); // once for all pieces
    std::string text;
    for (;;) {
        const auto piece =
            on(file, read, "Read", {handle, Variant{static_cast<std::int32_t>(transfer_piece)}}, 1);
        const auto* const part = piece[0].get_if<ByteString>();
        if (part == nullptr || part->span().empty()) {
            break;
        }
        text.append(reinterpret_cast<const char*>(part->span().data()), part->span().size());
        if (text.size() > most_fetched) {
            throw Failure{status::Bad_EncodingLimitsExceeded, name_};
        }
        if (progress) {
            progress(text.size());
        }
    }
    on(file, "Close", {handle}, 0);
    return text;
}

void RemoteTransfer::send(const Variant& options, std::string_view file, const Progress& progress)
{
    has_sent_all_ = false;
    const auto made = on(object_, "GenerateFileForWrite", {options}, 2);
    const NodeId node = made[0].value_or<NodeId>({});
    const Variant& handle = made[1];
    const NodeId write = find_method(connection_, node, "Write");
    const auto bytes = std::as_bytes(std::span{file.data(), file.size()});
    const std::size_t most = piece_to_write(connection_, node);
    for (std::size_t done = 0; done < bytes.size();) {
        const auto piece = bytes.subspan(done, std::min(most, bytes.size() - done));
        on(node, write, "Write", {handle, Variant{ByteString{piece}}}, 0);
        done += piece.size();
        if (progress) {
            progress(done);
        }
    }
    const NodeId commit = find_method(connection_, object_, "CloseAndCommit");
    has_sent_all_ = true;
    try {
        on(object_, commit, "CloseAndCommit", {handle}, 0);
    } catch (const Failure& failure) {
        if (failure.exit != Exit::NotConnected) {
            abandon(node, handle);
        }
        throw;
    }
}

/// Closes a refused file, which belongs to the client until then (Part 20, 4.4.2).
void RemoteTransfer::abandon(const NodeId& file, const Variant& handle)
{
    try {
        on(file, "Close", {handle}, 0);
    } catch (const Failure&) { // it is already gone
    }
}

Json RemoteTransfer::answer(const char* options, std::size_t max_size)
{
    auto json = busbar::detail::parse_json(fetch(Variant{options}), {.max_size = max_size});
    return json ? *std::move(json) : Json{};
}

std::string text_in(const Json& json, std::string_view name)
{
    const Json* const found = json.find(name);
    return found != nullptr ? found->text : std::string{};
}

std::span<const Json> items_in(const Json& json, std::string_view name)
{
    const Json* const found = json.find(name);
    return found != nullptr ? std::span<const Json>{found->items} : std::span<const Json>{};
}

} // namespace busbar::tool::admin
