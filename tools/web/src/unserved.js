// Browsers run no modules from the disk, but scripts like this one, which then shows what the page says of it.
if (location.protocol === 'file:')
    for (const line of document.querySelectorAll('.unserved')) line.hidden = false;
