#include "remote_files.hpp"

#include <algorithm>

#include <busbar/core/status_codes.hpp>

#include "tool/printing/display_text.hpp"

namespace busbar::tool::admin {

namespace {

constexpr std::uint8_t open_to_read = 1;
/// Number of times that a file may change while it is read.
constexpr unsigned max_changes = 100;

/// A file that is open for reading.
class RemoteReader {
public:
    RemoteReader(Connection& connection, const NodeId& node, const std::string& path)
        : connection_{connection}, node_{node}, path_{path}
    {
    }

    void open_at(std::uint64_t offset)
    {
        const auto opened = on("Open", {Variant{open_to_read}});
        handle_ = opened.empty() ? Variant{} : opened.front();
        if (offset != 0) {
            on("SetPosition", {handle_, Variant{offset}});
        }
    }
    /// Appends the next bytes; false at the end.
    bool read(std::string& text)
    {
        if (read_.is_null()) {
            read_ = find_method(connection_, node_, "Read"); // otherwise it would be looked up each
                                                             // time
        }
        const auto piece = call(connection_, node_, read_,
                                {handle_, Variant{static_cast<std::int32_t>(transfer_piece)}},
                                safe(path_) + ": Read");
        const auto* const part = piece.empty() ? nullptr : piece.front().get_if<ByteString>();
        if (part == nullptr || part->span().empty()) {
            return false;
        }
        text.append(reinterpret_cast<const char*>(part->span().data()), part->span().size());
        return true;
    }
    void close() { on("Close", {handle_}); }

private:
    std::vector<Variant> on(const char* method, const std::vector<Variant>& inputs)
    {
        return call_on_file(connection_, node_, path_, method, inputs);
    }

    Connection& connection_;
    const NodeId& node_;
    const std::string& path_;
    NodeId read_;
    Variant handle_;
};

} // namespace

NodeId file_root(Connection& connection)
{
    const NodeId system = standard(id::FileSystem);
    return objects_below(connection, system).empty() ? standard(id::ObjectsFolder) : system;
}

NodeId look_for_file(Connection& connection, std::string_view path)
{
    NodeId node = file_root(connection);
    while (!path.empty() && !node.is_null()) {
        const std::string_view name = path.substr(0, path.find('/'));
        path.remove_prefix(std::min(path.size(), name.size() + 1));
        const auto objects = objects_below(connection, node);
        const auto found =
            std::find_if(objects.begin(), objects.end(),
                         [&](const NamedChild& child) { return child.name == name; });
        node = found == objects.end() ? NodeId{} : found->id;
    }
    return node;
}

Variant file_property(Connection& connection, const NodeId& node, const char* name)
{
    const NodeId found = find_child(connection, node, name);
    return found.is_null() ? Variant{} : read(connection, found);
}

std::size_t piece_to_write(Connection& connection, const NodeId& file)
{
    Variant most = file_property(connection, file, "MaxByteStringLength");
    if (most.is_null()) {
        most = read(connection, standard(id::Server_ServerCapabilities_MaxByteStringLength));
    }
    const auto size = most.value_or<std::uint32_t>(0); // 0: there is no limit
    return size == 0 ? transfer_piece : std::min<std::size_t>(transfer_piece, size);
}

std::vector<Variant> call_on_file(Connection& connection, const NodeId& node,
                                  const std::string& path, const char* method,
                                  const std::vector<Variant>& inputs)
{
    const NodeId found = find_method(connection, node, method);
    if (found.is_null()) {
        throw Failure{
            status::Bad_NotFound, safe(path) + ": " + method,
            "it is not a file or folder of that kind, or this user may not do that with it"};
    }
    return call(connection, node, found, inputs, safe(path) + ": " + method);
}

std::string download(Connection& connection, const NodeId& node, const std::string& path,
                     const Download& what)
{
    RemoteReader reader{connection, node, path};
    reader.open_at(what.offset);
    std::string text;
    for (unsigned changes = 0;;) {
        try {
            if (!reader.read(text)) {
                break;
            }
        } catch (const Failure& failure) {
            // The file was replaced: read the new one.
            if (failure.status != status::Bad_InvalidState || !what.is_growing ||
                ++changes > max_changes) {
                throw;
            }
            reader.close();
            reader.open_at(what.offset + text.size());
        }
        if (text.size() > what.max_size) {
            throw Failure{status::Bad_EncodingLimitsExceeded, safe(path)};
        }
        if (what.progress) {
            what.progress(text.size());
        }
    }
    reader.close();
    return text;
}

void show_progress(Context& context, std::size_t done, std::size_t all)
{
    if (context.err.is_terminal() && all > transfer_piece) {
        context.err.write("\r" + std::to_string(done / 1'024) + " of " +
                          std::to_string(all / 1'024) + " KiB" + (done >= all ? "\n" : ""));
    }
}

} // namespace busbar::tool::admin
