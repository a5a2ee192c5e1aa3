# The bill of materials of a package: SPDX 2.3 as JSON, with each file and its checksums, the parts
# of others that are compiled in, and the shared libraries that its programs load.

# busbar_json(<variable> <text>): as a JSON string.
function(busbar_json variable text)
  string(REPLACE "\\" "\\\\" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  set(${variable} "\"${text}\"" PARENT_SCOPE)
endfunction()

# The entry of a package that `spdx_id` stands for.
function(busbar_bill_part variable spdx_id name version licence locator purpose)
  busbar_json(name ${name})
  busbar_json(locator ${locator})
  set(${variable} "{\"SPDXID\":\"${spdx_id}\",\"name\":${name},\"versionInfo\":\"${version}\",\
\"downloadLocation\":${locator},\"filesAnalyzed\":false,\"licenseConcluded\":\"${licence}\",\
\"licenseDeclared\":\"${licence}\",\"copyrightText\":\"NOASSERTION\",\
\"primaryPackagePurpose\":\"${purpose}\"}" PARENT_SCOPE)
endfunction()

# The packages of this machine that have the shared libraries which `files` name as needed.
function(busbar_loaded_packages variable files)
  find_program(OBJDUMP_PROGRAM objdump REQUIRED)
  set(packages "")
  foreach(file IN LISTS files)
    execute_process(COMMAND ${OBJDUMP_PROGRAM} -p ${file} OUTPUT_VARIABLE text ERROR_QUIET)
    string(REGEX MATCHALL "NEEDED +[^\n]+" needed "${text}")
    foreach(line IN LISTS needed)
      string(REGEX REPLACE "NEEDED +" "" library ${line})
      if(library MATCHES "^libbusbar_")
        list(APPEND packages libbusbar)
        continue()
      endif()
      execute_process(COMMAND dpkg-query -S "/${CPACK_BUSBAR_LIBDIR}/${library}"
        "/usr/${CPACK_BUSBAR_LIBDIR}/${library}" OUTPUT_VARIABLE owner ERROR_QUIET)
      string(REGEX MATCH "^[^:,\n]+" owner "${owner}")
      if(owner)
        list(APPEND packages ${owner})
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES packages)
  list(SORT packages)
  set(${variable} "${packages}" PARENT_SCOPE)
endfunction()

# Of the files below `root`, which are those of a component and a package.
function(busbar_write_bill root component name target created)
  file(GLOB_RECURSE paths LIST_DIRECTORIES false RELATIVE ${root} ${root}/*)
  list(SORT paths)
  set(files "")
  set(all_sha1 "")
  set(programs "")
  set(relations "{\"spdxElementId\":\"SPDXRef-DOCUMENT\",\"relationshipType\":\"DESCRIBES\",\
\"relatedSpdxElement\":\"SPDXRef-Package\"}")
  set(number 0)
  foreach(path IN LISTS paths)
    if(IS_SYMLINK ${root}/${path})
      continue()
    endif()
    math(EXPR number "${number} + 1")
    file(SHA1 ${root}/${path} sha1)
    file(SHA256 ${root}/${path} sha256)
    list(APPEND all_sha1 ${sha1})
    if(path MATCHES "/bin/|[.]so[.]")
      list(APPEND programs ${root}/${path})
    endif()
    busbar_json(text "./${path}")
    list(APPEND files "{\"SPDXID\":\"SPDXRef-File-${number}\",\"fileName\":${text},\"checksums\":[\
{\"algorithm\":\"SHA1\",\"checksumValue\":\"${sha1}\"},\
{\"algorithm\":\"SHA256\",\"checksumValue\":\"${sha256}\"}],\"licenseConcluded\":\"MIT\",\
\"licenseInfoInFiles\":[\"NOASSERTION\"],\"copyrightText\":\"NOASSERTION\"}")
    string(APPEND relations ",\n{\"spdxElementId\":\"SPDXRef-Package\",\"relationshipType\":\
\"CONTAINS\",\"relatedSpdxElement\":\"SPDXRef-File-${number}\"}")
  endforeach()
  # Of the checksums in order: what SPDX identifies the whole by.
  list(SORT all_sha1)
  string(JOIN "" together ${all_sha1})
  string(SHA1 code "${together}")

  set(parts "{\"SPDXID\":\"SPDXRef-Package\",\"name\":\"${name}\",\"versionInfo\":\
\"${CPACK_BUSBAR_VERSION}\",\"supplier\":\"Organization: ${CPACK_PACKAGE_VENDOR}\",\
\"downloadLocation\":\"NOASSERTION\",\"filesAnalyzed\":true,\"packageVerificationCode\":{\
\"packageVerificationCodeValue\":\"${code}\"},\"licenseConcluded\":\"MIT\",\"licenseDeclared\":\
\"MIT\",\"licenseInfoFromFiles\":[\"NOASSERTION\"],\"copyrightText\":\"NOASSERTION\"}")
  foreach(part IN LISTS CPACK_BUSBAR_PARTS)
    string(REPLACE "|" ";" part "${part}")
    list(POP_BACK part components)
    if(NOT ",${components}," MATCHES ",${component},")
      continue()
    endif()
    list(GET part 0 part_name)
    busbar_bill_part(text SPDXRef-Part-${part_name} ${part} LIBRARY)
    string(APPEND parts ",\n${text}")
    string(APPEND relations ",\n{\"spdxElementId\":\"SPDXRef-Package\",\"relationshipType\":\
\"STATIC_LINK\",\"relatedSpdxElement\":\"SPDXRef-Part-${part_name}\"}")
  endforeach()
  busbar_loaded_packages(loaded "${programs}")
  # Its own libraries need each other.
  list(REMOVE_ITEM loaded ${name})
  foreach(package IN LISTS loaded)
    set(version ${CPACK_BUSBAR_VERSION})
    if(NOT package STREQUAL "libbusbar")
      execute_process(COMMAND dpkg-query -W "-f=\${Version}" ${package} OUTPUT_VARIABLE version
        ERROR_QUIET)
    endif()
    string(REGEX REPLACE "[^A-Za-z0-9.-]" "-" id ${package})
    busbar_bill_part(text SPDXRef-Loaded-${id} ${package} "${version}" NOASSERTION NOASSERTION
      LIBRARY)
    string(APPEND parts ",\n${text}")
    string(APPEND relations ",\n{\"spdxElementId\":\"SPDXRef-Package\",\"relationshipType\":\
\"DYNAMIC_LINK\",\"relatedSpdxElement\":\"SPDXRef-Loaded-${id}\"}")
  endforeach()
  list(JOIN files ",\n" files)
  file(WRITE ${target} "{\"spdxVersion\":\"SPDX-2.3\",\"dataLicense\":\"CC0-1.0\",\
\"SPDXID\":\"SPDXRef-DOCUMENT\",\"name\":\"${name}-${CPACK_BUSBAR_VERSION}\",\
\"documentNamespace\":\"https://spdx.org/spdxdocs/${name}-${CPACK_BUSBAR_VERSION}-${code}\",\
\"creationInfo\":{\"created\":\"${created}\",\"creators\":[\"Tool: busbar-packaging\"]},\n\
\"packages\":[\n${parts}],\n\"files\":[\n${files}],\n\"relationships\":[\n${relations}]}\n")
endfunction()
