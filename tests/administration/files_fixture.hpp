#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/types/view.hpp>

#include "managed_fixture.hpp"

namespace busbar::test {

struct FilesFixture : ManagedFixture {
    FilesFixture()
    {
        REQUIRE(user_list.add({"eng", {}, 0, {}, {"Engineer"}}, "patience is all", random));
        REQUIRE(user_list.add({"op", {}, 0, {}, {"Operator"}}, "patience is all", random));
        REQUIRE(user_list.add({"looker", {}, 0, {}, {"Observer"}}, "patience is all", random));
    }
    TestClient log_in_as(const char* name) { return log_in(name, "patience is all"); }
    static NodeId node(const std::string& path = "")
    {
        return NodeId{1, String{"Files/recipes" + (path.empty() ? path : "/" + path)}};
    }
    static NodeId file_method(const char* name)
    {
        return NodeId{1, String{std::string{"FileTypes/recipes//"} + name}};
    }
    static NodeId folder_method(const char* name)
    {
        return NodeId{1, String{std::string{"Files/recipes//"} + name}};
    }
    CallMethodResult on(TestClient& client, const std::string& path, const char* method,
                        std::vector<Variant> inputs)
    {
        const std::string_view name = method;
        const bool is_of_folder =
            name.starts_with("Create") || name == "Delete" || name == "MoveOrCopy";
        return call(client, node(path), is_of_folder ? folder_method(method) : file_method(method),
                    std::move(inputs));
    }
    std::string_view why(TestClient& client, const std::string& path, const char* method,
                         std::vector<Variant> inputs)
    {
        return name(on(client, path, method, std::move(inputs)).status_code);
    }
    Variant open(TestClient& client, const std::string& path, std::uint8_t mode)
    {
        const auto result = on(client, path, "Open", {Variant{mode}});
        REQUIRE(result.status_code == status::Good);
        return result.output_arguments[0];
    }
    void write(TestClient& client, const std::string& path, std::string_view text)
    {
        const Variant handle = open(client, path, writing);
        CHECK(why(client, path, "Write",
                  {handle, Variant{ByteString{std::as_bytes(std::span{text})}}}) == "Good");
        CHECK(why(client, path, "Close", {handle}) == "Good");
    }
    std::string text(TestClient& client, const std::string& path)
    {
        const Variant handle = open(client, path, reading);
        const auto result = on(client, path, "Read", {handle, Variant{std::int32_t{1'000}}});
        REQUIRE(result.status_code == status::Good);
        CHECK(why(client, path, "Close", {handle}) == "Good");
        const auto bytes = result.output_arguments[0].get_if<ByteString>()->span();
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    static DataValue value(TestClient& client, const std::string& path, const char* property)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id =
            NodeId{1, String{"Files/recipes/" + path + "//" + property}};
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    /// The BrowseNames of what a folder organizes.
    static std::vector<std::string> names(TestClient& client, const std::string& path = "")
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = node(path);
        request.nodes_to_browse[0].reference_type_id = NodeId{0, id::Organizes};
        request.nodes_to_browse[0].result_mask = 63;
        const auto response = client.call<BrowseResponse>(request);
        REQUIRE(response);
        std::vector<std::string> result;
        for (const auto& each : response->results[0].references) {
            result.push_back(each.browse_name.name.str());
        }
        return result;
    }
    std::string_view make(TestClient& client, const std::string& folder, const char* name)
    {
        return why(client, folder, "CreateFile", {Variant{String{name}}, Variant{false}});
    }
    std::string_view make_folder(TestClient& client, const std::string& folder, const char* name)
    {
        return why(client, folder, "CreateDirectory", {Variant{String{name}}});
    }
    std::string_view move(TestClient& client, const std::string& folder, const std::string& what,
                          const std::string& target, const char* new_name = "", bool copies = false)
    {
        return why(client, folder, "MoveOrCopy",
                   {Variant{node(what)}, Variant{node(target)}, Variant{copies},
                    Variant{String{new_name}}});
    }
    bool is_stored(const std::string& path) { return file_storage.entry(path).has_value(); }
};

using Names = std::vector<std::string>;

} // namespace busbar::test
