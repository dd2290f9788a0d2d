#!/usr/bin/env bash
# Prepares what the OpenXR tests run against: a folder with Debian 13's Monado and Mesa, which an
# older Debian lacks. Nothing of it is installed; the tests start it through its own loader.
#   monado-tree.sh DIR      prepares DIR (about 700 MB), or leaves it be where it is ready
# Wants Debian, root, the network and the package mmdebstrap.
set -euo pipefail
tree=${1:?"usage: monado-tree.sh DIR"}
packages=monado-service,monado-cli,libopenxr1-monado,libopenxr-loader1,mesa-vulkan-drivers
packages+=,libvulkan1,vulkan-validationlayers,openxr-layer-corevalidation,ca-certificates
stamp=$tree/.ready

if test -f "$stamp" && test "$(cat "$stamp")" = "$packages"; then
    exit 0
fi
if ! command -v mmdebstrap >/dev/null; then
    echo "monado-tree: mmdebstrap is missing; apt-get install mmdebstrap" >&2
    exit 1
fi
# The mirror that this machine is configured with; it holds the newer release too.
mirror=$(apt-get indextargets --format '$(REPO_URI) $(COMPONENT)' 2>/dev/null |
    awk '$2 == "main" && $1 !~ /security/ { print $1; exit }')
if test -z "$mirror"; then
    echo "monado-tree: apt is configured with no mirror of Debian's main; see sources.list(5)" >&2
    exit 1
fi
rm -rf "$tree"
mkdir -p "$(dirname "$tree")"
# mmdebstrap unpacks with its helper mmtarfilter, which it looks for in PATH.
PATH=/usr/sbin:/usr/bin:/sbin:/bin mmdebstrap --mode=root --variant=apt \
    --include="$packages" \
    --aptopt='Apt::Install-Recommends "false"' \
    --dpkgopt='path-exclude=/usr/share/man/*' \
    --dpkgopt='path-exclude=/usr/share/doc/*' \
    --dpkgopt='path-exclude=/usr/share/locale/*' \
    trixie "$tree" "$mirror"
echo "$packages" >"$stamp"
