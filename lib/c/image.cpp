#include <chrono>
#include <cstdint>
#include <utility>

#include <busbar/server/process_image.hpp>
#include <busbar/types/ids.hpp>

#include "server.hpp"
#include "structure.hpp"

/// An image, which the server owns.
struct busbar_image {
    std::shared_ptr<busbar::server::ProcessImage> image;
    std::shared_ptr<busbar::server::ImageSource> source;
};

namespace busbar::c {

namespace {

/// Returns a variable with its place in the program's memory. Bad_OutOfRange outside of it.
Result<server::ImageVariable> placed(const busbar_image_config& config,
                                     const busbar_image_variable& from)
{
    auto variable = image_variable_of(from.field);
    if (!variable) {
        return variable;
    }
    server::ImageLayout alone;
    if (const auto added = alone.add(*variable); !added) {
        return fail(added.error());
    }
    const std::size_t bytes = alone[0].bytes();
    if (from.offset > config.memory_size || bytes > config.memory_size - from.offset) {
        return fail(status::Bad_OutOfRange);
    }
    variable->runtime = {static_cast<std::byte*>(config.memory) + from.offset, bytes};
    variable->is_read_only = !from.is_writable;
    return variable;
}

/// Adds the Variables, or none.
class AddedVariables {
public:
    explicit AddedVariables(model::AddressSpace& space) : space_{&space} {}
    AddedVariables(const AddedVariables&) = delete;
    AddedVariables& operator=(const AddedVariables&) = delete;
    ~AddedVariables()
    {
        for (const model::NodeIndex node : nodes_) {
            busbar::detail::attempt([&] { static_cast<void>(space_->remove(node)); });
        }
    }
    StatusCode add(const busbar_image_config& config, const busbar_image_variable& from,
                   const server::ImageSource& source, std::uint32_t handle, const Variant& like);
    void keep() { nodes_.clear(); }

private:
    model::AddressSpace* space_;
    std::vector<model::NodeIndex> nodes_;
};

StatusCode AddedVariables::add(const busbar_image_config& config, const busbar_image_variable& from,
                               const server::ImageSource& source, std::uint32_t handle,
                               const Variant& like)
{
    busbar_node in_c{};
    in_c.parent = config.parent;
    in_c.namespace_index = config.namespace_index;
    in_c.name = from.field.name;
    const auto node = new_node_of(*space_, in_c, id::ObjectsFolder);
    if (!node) {
        return node.error();
    }
    model::NewVariable variable;
    if (const StatusCode shaped = set_shape(*space_, like, variable); shaped.is_bad()) {
        return shaped;
    }
    variable.source = source.index();
    variable.handle = handle;
    variable.access_level = from.is_writable ? model::Access::ReadWrite : model::Access::Read;
    nodes_.reserve(nodes_.size() + 1);
    const auto added = space_->add_variable(*node, variable);
    if (!added) {
        return added.error();
    }
    nodes_.push_back(*added);
    return status::Good;
}

StatusCode add_all(busbar_server& server, const busbar_image_config& config, busbar_image& made)
{
    server::ImageLayout layout;
    for (std::size_t i = 0; i < config.count; ++i) {
        auto variable = placed(config, config.variables[i]);
        if (!variable) {
            return misconfigured(server.failure, "variables", i, "has no place in the memory",
                                 variable.error());
        }
        if (const auto added = layout.add(*variable); !added) {
            return misconfigured(server.failure, "variables", i, "is not aligned, or too large",
                                 added.error());
        }
    }
    server::ImageOptions options;
    options.cycle = std::chrono::microseconds{config.cycle_us};
    made.image = server::ProcessImage::create(std::move(layout), options);
    made.source = std::make_shared<server::ImageSource>(made.image);
    server.server->add_source(*made.source); // which detaches itself if something fails
    AddedVariables variables{server.server->address_space()};
    for (std::uint32_t handle = 0; handle < config.count; ++handle) {
        const busbar_image_variable& from = config.variables[handle];
        // The first values come from empty memory, as the program has perhaps written nothing yet.
        server::ImageLayout alone;
        auto like = image_variable_of(from.field);
        static_cast<void>(alone.add(*like));
        const StatusCode added =
            variables.add(config, from, *made.source, handle, server::ImageMemory{alone}.load(0));
        if (added.is_bad()) {
            return misconfigured(server.failure, "variables", handle, "cannot be added", added);
        }
    }
    variables.keep();
    return status::Good;
}

} // namespace

} // namespace busbar::c

using namespace busbar;

busbar_status busbar_server_add_image(busbar_server* server, const busbar_image_config* config,
                                      busbar_image** image)
{
    return c::change(server, [&]() -> StatusCode {
        if (config == nullptr || config->size != sizeof *config || config->memory == nullptr ||
            config->variables == nullptr || image == nullptr || config->count > c::max_elements) {
            return status::Bad_InvalidArgument;
        }
        *image = nullptr;
        auto made = std::make_shared<busbar_image>();
        server->owned.reserve(server->owned.size() + 1);
        const StatusCode added = c::add_all(*server, *config, *made);
        if (added.is_good()) {
            *image = made.get();
            server->owned.push_back(std::move(made));
        }
        return added;
    });
}

void busbar_image_begin_scan(busbar_image* image)
{
    if (image != nullptr) {
        image->image->begin_scan();
    }
}

void busbar_image_publish(busbar_image* image, busbar_time time)
{
    if (image != nullptr) {
        image->image->publish(DateTime{time});
    }
}

void busbar_image_halt(busbar_image* image)
{
    if (image != nullptr) {
        image->image->halt();
    }
}
