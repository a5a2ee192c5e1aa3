#include <catch2/catch.hpp>

#include <busbar/di/nodes.hpp>
#include <busbar/model/nodeset.hpp>
#include <busbar/plcopen/nodes.hpp>
#include <model/space_hash.hpp>

namespace busbar::model::companion_load_test {

TEST_CASE("DI and PLCopen loaded or linked give the same address space")
{
    const std::string folder = BUSBAR_SOURCE_DIR "/schemas/companion/";
    const std::vector<NodeSetSource> sources{{folder + "Opc.Ua.Di.NodeSet2.xml"},
                                             {folder + "Opc.Ua.PLCopen.NodeSet2.xml"}};
    AddressSpace loaded;
    AddressSpace linked;
    SECTION("alone") {}
    SECTION("beside another namespace")
    {
        REQUIRE(loaded.add_namespace("urn:other"));
        REQUIRE(linked.add_namespace("urn:other"));
    }
    SECTION("with their namespaces in another order")
    {
        for (const char* uri :
             {"http://PLCopen.org/OpcUa/IEC61131-3/", "http://opcfoundation.org/UA/DI/"}) {
            REQUIRE(linked.add_namespace(uri));
        }
    }
    REQUIRE(load_nodesets(loaded, sources));
    REQUIRE(linked.add(di::nodes()));
    REQUIRE(linked.add(plcopen::nodes()));
    CHECK(loaded.node_count() == linked.node_count());
    CHECK(detail::space_hash(loaded) == detail::space_hash(linked));
}

} // namespace busbar::model::companion_load_test
