// A press with a Method to start it and an event of a type of its own when it is done.
// usage: EXAMPLE_PASSWORD=... press-server [PORT]
#include <chrono>
#include <cstdlib>
#include <thread>

#include <busbar/net/server_app.hpp>
#include <busbar/server/method_table.hpp>

using namespace busbar;

namespace {

/// The nodes of the press in the address space.
struct Nodes {
    NodeId press;
    NodeId stroke_done; // the type of its events
};

/// An argument that is one value of a built-in type.
Argument argument(const char* name, std::uint32_t type)
{
    Argument made;
    made.name = name;
    made.data_type = NodeId{0, type};
    made.value_rank = -1; // a scalar
    return made;
}

Result<Nodes> add_press(model::AddressSpace& space, std::uint16_t ns)
{
    model::NewNode press;
    press.browse_name = {ns, "Press"};
    press.parent = space.find(id::ObjectsFolder);
    // Clients subscribe to events at an Object that is a notifier. The Server object gets them too.
    const auto object = space.add_object(press, {.event_notifier = 1});
    if (!object) {
        return fail(object.error());
    }
    model::NewNode type;
    type.browse_name = {ns, "StrokeDoneEventType"};
    type.parent = space.find(id::BaseEventType);
    const auto event = space.add_object_type(type);
    if (!event) {
        return fail(event.error());
    }
    model::NewNode force;
    force.browse_name = {ns, "Force"};
    force.parent = *event;
    model::NewVariable number;
    number.data_type = NodeId{0, id::Double};
    const auto field = space.add_property(force, number);
    if (!field) {
        return fail(field.error());
    }
    return Nodes{space.node_id(*object), space.node_id(*event)};
}

/// The stroke: half a second later the Call is answered and the event raised.
void run_stroke(server::MethodCall call, const std::shared_ptr<server::EventQueue>& events,
                const Nodes& nodes, std::uint16_t ns)
{
    const auto force = call.input<double>(0);
    std::this_thread::sleep_for(std::chrono::milliseconds{500});
    server::Event event;
    event.event_type = nodes.stroke_done;
    event.source_node = nodes.press;
    event.source_name = "Press";
    event.message = LocalizedText{"en", "The stroke is done"};
    event.severity = 300;
    event.set({ns, "Force"}, force);
    events->raise(std::move(event)); // from any thread
    call.succeed({Variant{force * 0.98}});
}

Result<void> add_start(net::ServerApp& app, const Nodes& nodes, std::uint16_t ns)
{
    model::AddressSpace& space = app.server()->address_space();
    auto& methods = app.make_source<server::MethodTable>();
    const std::uint64_t start = methods.add([&app, nodes, ns](server::MethodCall call) {
        if (const auto force = call.input<double>(0); force <= 0 || force > 250) {
            call.refuse({status::Bad_OutOfRange}, "Force must be above 0 and at most 250 kN");
            return;
        }
        // Slow work keeps the call and answers it later. A program with more to do has a queue.
        std::thread{run_stroke, std::move(call), app.server()->event_queue(), nodes, ns}.detach();
    });
    model::NewNode node;
    node.browse_name = {ns, "Start"};
    node.parent = space.find(nodes.press);
    model::NewMethod method;
    method.input_arguments = {argument("Force", id::Double)};
    method.output_arguments = {argument("Reached", id::Double)};
    method.source = methods.index();
    method.handle = start;
    return space.add_method(node, method).transform([](auto) {});
}

} // namespace

int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    net::ServerApp app{{"urn:example:press-server", "Press server", "server_pki"},
                       "opc.tcp://localhost:" + port};
    app.add_user("operator", std::getenv("EXAMPLE_PASSWORD"));
    const std::uint16_t ns = app.add_namespace("urn:example:press");
    if (app.server() != nullptr) {
        const auto added =
            add_press(app.server()->address_space(), ns).and_then([&](const Nodes& nodes) {
                return add_start(app, nodes, ns);
            });
        if (!added) {
            return 1;
        }
    }
    return app.run();
}
