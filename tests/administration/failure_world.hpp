#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <busbar/types/attribute.hpp>

#include "configuration_fixture.hpp"
#include "support/failing_allocation.hpp"
#include "trust_list_ids.hpp"

namespace busbar::test {

/// A server whose administrator calls Methods while memory fails: what the server does is counted,
/// what the test does is not.
struct FailureWorld : Configuration {
    static constexpr const char* password = "patience is all";
    /// What it may have been changed to.
    static constexpr const char* other_password = "patience is enough";

    explicit FailureWorld(ManualWorker* hashes = nullptr) : Configuration{hashes}
    {
        REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    }

    /// One Method.
    [[nodiscard]] static CallRequest calling(const NodeId& object, const NodeId& method,
                                             const std::vector<Variant>& inputs)
    {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = object;
        request.methods_to_call[0].method_id = method;
        request.methods_to_call[0].input_arguments = Array<Variant>{inputs};
        return request;
    }
    /// What the test needs for a Method; its outputs.
    Array<Variant> need(const CallRequest& request)
    {
        const auto sent = root.send(request);
        settle();
        const auto response = root.take<CallResponse>(sent);
        REQUIRE(response);
        INFO(name(response->results[0].status_code) << "\n" << log.text);
        REQUIRE(response->results[0].status_code == status::Good);
        return response->results[0].output_arguments;
    }
    /// The same, but that it may refuse.
    void may(const CallRequest& request)
    {
        const auto sent = root.send(request);
        settle();
        REQUIRE(root.take<CallResponse>(sent));
    }
    /// What the server does for a request of one Method or Write, with its worker, counted.
    /// Bad_ConnectionClosed if it closes the connection.
    StatusCode ask(const CallRequest& request)
    {
        const auto response = root.take<CallResponse>(send_counted(request));
        return !response ? response.error() : response->results[0].status_code;
    }
    StatusCode ask(const WriteRequest& request)
    {
        const auto response = root.take<WriteResponse>(send_counted(request));
        return !response ? response.error() : response->results[0];
    }
    /// One Variable's Value.
    [[nodiscard]] static WriteRequest writing_to(const NodeId& variable, Variant value)
    {
        WriteRequest request;
        WriteValue& one = request.nodes_to_write.emplace_back();
        one.node_id = variable;
        one.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        one.value.value = std::move(value);
        return request;
    }
    /// A connection for the session of one that was closed.
    void connect_again()
    {
        TestClient next = connect();
        next.adopt(root);
        StatusCode activated = next.activate(next.user("root", password));
        if (activated.is_bad()) {
            activated = next.activate(next.user("root", other_password));
        }
        REQUIRE(activated == status::Good);
        root = std::move(next);
    }

    // Methods of one Object each.

    [[nodiscard]] static CallRequest on_server(std::uint32_t method,
                                               const std::vector<Variant>& inputs)
    {
        return calling(NodeId{0, id::ServerConfiguration}, NodeId{0, method}, inputs);
    }
    [[nodiscard]] static CallRequest on_list(std::uint32_t method,
                                             const std::vector<Variant>& inputs)
    {
        return calling(NodeId{0, trust_list}, NodeId{0, method}, inputs);
    }
    [[nodiscard]] static CallRequest on_users(std::uint32_t method,
                                              const std::vector<Variant>& inputs)
    {
        return calling(NodeId{0, id::UserManagement}, NodeId{0, method}, inputs);
    }
    [[nodiscard]] static CallRequest on_roles(std::uint32_t method,
                                              const std::vector<Variant>& inputs)
    {
        return calling(NodeId{0, id::Server_ServerCapabilities_RoleSet}, NodeId{0, method}, inputs);
    }
    [[nodiscard]] static NodeId file(const std::string& path)
    {
        return NodeId{1, String{"Files/recipes" + (path.empty() ? path : "/" + path)}};
    }
    [[nodiscard]] static CallRequest on_file(const std::string& path, const char* method,
                                             const std::vector<Variant>& inputs)
    {
        return calling(file(path), NodeId{1, String{std::string{"FileTypes/recipes//"} + method}},
                       inputs);
    }
    [[nodiscard]] static CallRequest on_folder(const char* method,
                                               const std::vector<Variant>& inputs)
    {
        return calling(file(""), NodeId{1, String{std::string{"Files/recipes//"} + method}},
                       inputs);
    }
    [[nodiscard]] static CallRequest on_transfer(const NodeId& object, const char* method,
                                                 const std::vector<Variant>& inputs)
    {
        return calling(object, NodeId{1, String{object.string().str() + "//" + method}}, inputs);
    }

    /// What was thrown out of the server.
    int thrown{0};
    TestClient root{log_in_root()};

private:
    [[nodiscard]] TestClient log_in_root()
    {
        REQUIRE(user_list.add(
            {"root", {}, 0, {}, {"SecurityAdmin", "ConfigureAdmin", "Engineer", "Operator"}},
            password, random));
        return log_in("root", password);
    }
    template <typename Request>
    [[nodiscard]] std::uint32_t send_counted(const Request& request)
    {
        Request sent = request;
        sent.request_header.authentication_token = root.authentication_token;
        sent.request_header.request_handle = ++root.last_handle;
        const auto id = root.channel.send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, Request::binary_encoding_id});
            encode(writer, sent);
        });
        REQUIRE(id);
        const auto bytes = take_output(root.channel);
        counted([&] { static_cast<void>(root.connection.feed(bytes, now)); });
        do_counted();
        settle(); // what a failure has put off
        return *id;
    }
    template <typename Work>
    void counted(Work work)
    {
        thrown += survives_counted(std::move(work)) ? 0 : 1;
    }
    [[nodiscard]] std::vector<std::function<void()>> take_jobs()
    {
        auto* const manual = static_cast<ManualWorker*>(worker);
        return manual != nullptr ? std::exchange(manual->jobs, {})
                                 : std::vector<std::function<void()>>{};
    }
    /// As long as there is something to do.
    void do_counted()
    {
        for (bool is_more = true; is_more;) {
            is_more = false;
            for (auto& job : take_jobs()) {
                // As a WorkerThread ends what a job throws.
                static_cast<void>(survives_counted(job));
                counted([&] { job = nullptr; });
                is_more = true;
            }
            if (std::exchange(waker.is_awake, false)) {
                counted([&] { server.handle_completions(now); });
                is_more = true;
            }
        }
    }
    void settle()
    {
        for (bool is_more = true; is_more;) {
            auto jobs = take_jobs();
            for (const auto& job : jobs) {
                job();
            }
            is_more = !jobs.empty() || waker.is_awake;
            jobs.clear();
            complete();
        }
    }
};

} // namespace busbar::test
