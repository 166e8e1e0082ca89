// The page's player shows the stream that its address names: index.html?src=show.nvs
import './neuvv-player.js';

document.querySelector('neuvv-player').src = new URLSearchParams(location.search).get('src') ?? 'show.nvs';
